#pragma once

#include <sys/types.h>

#include <map>
#include <string>
#include <thread>
#include <vector>

#include "common/sync.h"

// Runs the project's binaries as a person would, as processes, through pipes or a terminal; or,
// where that shows nothing more, the same commands in this process, which saves the time to start
// one.

namespace strata::test {

/// How a process ended and what it said.
struct CommandResult {
  int exit_status = -1;  ///< -signal where a signal ended it.
  std::string out, err;
};

struct RunOptions {
  std::map<std::string, std::string> environment;  ///< On top of this process's.
  std::string directory;                           ///< To run in; empty: this one.
  int terminal_columns = 0;  ///< More than 0: standard error is a terminal of this width.
};

/// A binary of the project that runs. Ends it (SIGKILL) if it still does at the end of its life.
class RunningCommand {
 public:
  /// `words` is the binary's name and its arguments, such as {"strata", "--help"}.
  explicit RunningCommand(const std::vector<std::string>& words, const RunOptions& options = {});
  ~RunningCommand();
  RunningCommand(const RunningCommand&) = delete;
  RunningCommand& operator=(const RunningCommand&) = delete;

  /// Waits until the regular expression is found in standard error (or output); false when the
  /// process ended without.
  bool WaitForError(const std::string& pattern) { return WaitFor(err_, pattern); }
  bool WaitForOutput(const std::string& pattern) { return WaitFor(out_, pattern); }
  void Signal(int signal);
  /// Waits until the process handles the signal in its own way; false when it ended without.
  bool WaitForHandlerOf(int signal);
  /// Waits for its end.
  CommandResult Wait();

 private:
  struct Stream {
    int descriptor = -1;
    std::string text;
    bool ended = false;
    std::thread reader;
  };
  bool WaitFor(Stream& stream, const std::string& pattern);
  void Read(Stream& stream);

  pid_t pid_ = -1;
  bool waited_ = false;
  Mutex mutex_;  ///< Guards the streams' text and ended.
  CondVar grown_;
  Stream out_, err_;
};

/// Runs `strata` with these arguments to its end.
CommandResult RunStrata(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// The same in this process, without a terminal. For commands that start no farm.
CommandResult RunInProcess(const std::vector<std::string>& arguments);

}  // namespace strata::test
