#pragma once

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace strata {

/// Polls until `condition` holds; false when it did not within the generous time a loaded machine
/// may need.
bool Eventually(const std::function<bool()>& condition);

/// A directory that is removed with this object.
class ScratchDirectory {
 public:
  ScratchDirectory();
  ~ScratchDirectory();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// A program of this build, ended by its own pid with this object.
class Process {
 public:
  /// `program` of the build's bin directory; its output goes to `log`. `environment` is on top of
  /// this process's.
  Process(const std::string& program, const std::vector<std::string>& arguments,
          const std::filesystem::path& log,
          const std::map<std::string, std::string>& environment = {});
  ~Process();
  Process(Process&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}

  void Signal(int signal);
  bool Running();
  /// Its exit status, or minus the signal that ended it.
  int Wait();

 private:
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

}  // namespace strata
