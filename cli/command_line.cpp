#include "cli/command_line.h"

#include <absl/strings/str_replace.h>

#include "cli/suggestion.h"
#include "common/build_info.h"

namespace strata {
namespace {

/// " - did you mean X?", or nothing when no known word is near.
std::string DidYouMean(const std::string& word, const std::vector<std::string>& known) {
  const std::string nearest = NearestWord(word, known);
  return nearest.empty() ? "" : absl::StrCat(" - did you mean ", nearest, "?");
}

std::vector<std::string> OptionNames(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options()) {
    if (option->get_group().empty()) continue;
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

/// Help in columns that fit a terminal, with the examples under it.
std::string ExamplesFooter(const std::vector<std::string>& examples) {
  std::string footer = "Examples:";
  for (const std::string& example : examples) footer += "\n  " + example;
  return footer;
}

}  // namespace

CommandLine::CommandLine()
    : app_(
          "Renders pbrt-v4 scenes on this machine or on a farm, and says how large the error of "
          "every pixel is.",
          "strata") {
  app_.set_version_flag("--version", "strata " + BuildRevision());
  app_.allow_extras();
  app_.get_formatter()->column_width(34);
  app_.footer("Run 'strata COMMAND --help' for the options of a command and examples.");
}

CLI::App* CommandLine::Add(const std::string& name, const std::string& summary,
                           const std::vector<std::string>& examples, Run run) {
  CLI::App* command = app_.add_subcommand(name, summary);
  command->allow_extras();
  command->footer(ExamplesFooter(examples));
  commands_.push_back({command, std::move(run)});
  return command;
}

const CommandLine::Command* CommandLine::Chosen() const {
  for (const Command& command : commands_) {
    if (command.app->parsed()) return &command;
  }
  return nullptr;
}

absl::Status CommandLine::CheckLeftovers() const {
  const Command* chosen = Chosen();
  if (chosen == nullptr) {
    const std::vector<std::string> rest = app_.remaining();
    if (rest.empty()) return absl::InvalidArgumentError("no command given; see 'strata --help'");
    std::vector<std::string> names;
    for (const Command& command : commands_) names.push_back(command.app->get_name());
    return absl::InvalidArgumentError(absl::StrCat("there is no command '", rest.front(), "'",
                                                   DidYouMean(rest.front(), names),
                                                   "; see 'strata --help'"));
  }
  const std::string name = absl::StrCat("strata ", chosen->app->get_name());
  const std::vector<std::string> rest = chosen->app->remaining();
  for (const std::string& word : rest) {
    if (word.size() < 2 || word.front() != '-') continue;
    const std::string option = word.substr(0, word.find('='));
    return absl::InvalidArgumentError(absl::StrCat(name, ": there is no option ", option,
                                                   DidYouMean(option, OptionNames(*chosen->app)),
                                                   "; see '", name, " --help'"));
  }
  if (rest.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      name, ": '", rest.front(), "' is one argument too many; see '", name, " --help'"));
}

absl::Status CommandLine::Parse(int argc, const char* const* argv, Console& console,
                                bool* help_shown) {
  try {
    app_.parse(argc, argv);
  } catch (const CLI::Success& asked) {  // --help or --version.
    *help_shown = true;
    const bool version = dynamic_cast<const CLI::CallForVersion*>(&asked) != nullptr;
    console.Result(version ? asked.what() : app_.help());  // Of the chosen command, if any.
    return absl::OkStatus();
  } catch (const CLI::ParseError& error) {
    // A misspelt option often makes another argument missing; it is the cause, so it goes first.
    const Command* chosen = Chosen();
    if (chosen != nullptr) STRATA_RETURN_IF_ERROR(CheckLeftovers());
    const std::string name =
        chosen ? absl::StrCat("strata ", chosen->app->get_name()) : std::string("strata");
    return absl::InvalidArgumentError(
        absl::StrCat(name, ": ", absl::StrReplaceAll(error.what(), {{"\n", "; "}}), "; see '", name,
                     " --help'"));
  }
  return CheckLeftovers();
}

ExitStatus CommandLine::Main(int argc, const char* const* argv, Console& console) {
  bool help_shown = false;
  absl::Status status = Parse(argc, argv, console, &help_shown);
  if (status.ok()) {
    if (help_shown) return ExitStatus::kDone;
    const absl::StatusOr<ExitStatus> exit = Chosen()->run(console);
    if (exit.ok()) return *exit;
    status = exit.status();
  }
  console.Error(std::string(status.message()));
  return ExitStatusOf(status);
}

}  // namespace strata
