#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/exit_status.h"

namespace strata {

/// The commands of `strata`. Parses the arguments, runs the command they name and turns what comes
/// of it into one line on stderr and an exit status.
class CommandLine {
 public:
  using Run = std::function<absl::StatusOr<ExitStatus>(Console&)>;

  CommandLine();

  /// A command named `name`; the caller adds its options. `examples` are whole command lines for
  /// its
  /// --help.
  CLI::App* Add(const std::string& name, const std::string& summary,
                const std::vector<std::string>& examples, Run run);

  ExitStatus Main(int argc, const char* const* argv, Console& console);

 private:
  struct Command {
    CLI::App* app;
    Run run;
  };
  absl::Status Parse(int argc, const char* const* argv, Console& console, bool* help_shown);
  absl::Status CheckLeftovers() const;
  const Command* Chosen() const;

  CLI::App app_;
  std::vector<Command> commands_;
};

}  // namespace strata
