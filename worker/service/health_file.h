#pragma once

#include <filesystem>
#include <string_view>

namespace strata {

/// Tells other processes how a worker's link is: one word, and by the file's time that it is fresh.
class HealthFile {
 public:
  static constexpr std::string_view kConnected = "connected", kConnecting = "connecting";

  /// Does nothing with an empty path.
  explicit HealthFile(std::filesystem::path path) : path_(std::move(path)) {}
  ~HealthFile();

  /// A file that cannot be written is told of in the log.
  void Write(std::string_view state) const;

 private:
  const std::filesystem::path path_;
};

}  // namespace strata
