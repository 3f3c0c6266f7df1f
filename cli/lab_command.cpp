#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "cli/format.h"
#include "cli/lab/experiment.h"
#include "cli/lab/figure.h"
#include "cli/lab/report.h"
#include "cli/suggestion.h"

namespace strata {
namespace {

struct LabOptions {
  std::string name;
  lab::Settings settings;
  bool csv = false, markdown = false;
  std::string out;
};

/// For people what each does; as comma-separated values what `--samples` counts.
void ListExperiments(bool csv, Console& console) {
  if (csv) {
    lab::Records records = {{"name", "samples are", "default"}, {}};
    for (const lab::Experiment& experiment : lab::Experiments()) {
      records.rows.push_back({std::string(experiment.name), std::string(experiment.samples),
                              static_cast<double>(experiment.default_samples)});
    }
    for (const std::string& line : CsvLines(records)) console.Result(line);
    return;
  }
  Table table({{"NAME"}, {"WHAT IT DOES"}});
  for (const lab::Experiment& experiment : lab::Experiments()) {
    table.Add({std::string(experiment.name), std::string(experiment.sentence)});
  }
  for (const std::string& line : table.Lines()) console.Result(line);
}

/// `--samples`, or what the experiment has without it.
lab::Settings SettingsFor(const lab::Experiment& experiment, const LabOptions& options) {
  lab::Settings settings = options.settings;
  if (settings.samples == 0) settings.samples = experiment.default_samples;
  return settings;
}

/// Runs it, writes its figure to `figure` unless that is empty, and prints.
absl::Status RunExperiment(const lab::Experiment& experiment, const LabOptions& options,
                           const std::filesystem::path& figure, Console& console) {
  if (!figure.empty()) STRATA_RETURN_IF_ERROR(CheckFigure(experiment, figure));
  STRATA_ASSIGN_OR_RETURN(const lab::Outcome outcome,
                          experiment.run(SettingsFor(experiment, options)));
  const std::vector<std::string> lines = options.csv ? CsvLines(outcome.records)
                                         : options.markdown
                                             ? MarkdownLines(experiment, outcome, figure.string())
                                             : TextLines(experiment, outcome);
  for (const std::string& line : lines) console.Result(line);
  return figure.empty() ? absl::OkStatus() : WriteFigure(outcome, figure);
}

/// All one after the other; `--out` is the folder of their figures.
absl::Status RunAllExperiments(const LabOptions& options, Console& console) {
  if (!options.out.empty() && !std::filesystem::is_directory(options.out)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--out: ", options.out, " is no folder, in which 'all' writes its figures"));
  }
  for (const lab::Experiment& experiment : lab::Experiments()) {
    const std::filesystem::path figure =
        options.out.empty()
            ? std::filesystem::path()
            : std::filesystem::path(options.out) / absl::StrCat(experiment.name, ".png");
    STRATA_RETURN_IF_ERROR(RunExperiment(experiment, options, figure, console));
    if (!options.markdown) console.Result("");
  }
  return absl::OkStatus();
}

absl::StatusOr<ExitStatus> RunLab(const LabOptions& options, Console& console) {
  if (options.csv && options.markdown) {
    return absl::InvalidArgumentError("--csv and --markdown exclude each other");
  }
  if (options.name == "list") {
    ListExperiments(options.csv, console);
  } else if (options.name == "all") {
    STRATA_RETURN_IF_ERROR(RunAllExperiments(options, console));
  } else if (const lab::Experiment* experiment = lab::FindExperiment(options.name)) {
    STRATA_RETURN_IF_ERROR(RunExperiment(*experiment, options, options.out, console));
  } else {
    std::vector<std::string> names = {"list", "all"};
    for (const lab::Experiment& known : lab::Experiments()) names.emplace_back(known.name);
    const std::string nearest = NearestWord(options.name, names);
    return absl::InvalidArgumentError(
        absl::StrCat("there is no experiment '", options.name, "'",
                     nearest.empty() ? "" : absl::StrCat(" - did you mean ", nearest, "?"),
                     "; 'strata lab list' has them all"));
  }
  return ExitStatus::kDone;
}

}  // namespace

void AddLabCommand(CommandLine& commands) {
  const auto options = std::make_shared<LabOptions>();
  CLI::App* command = commands.Add(
      "lab", "Run a classic experiment of Monte Carlo integration and print what it gives",
      {"strata lab list", "strata lab importance", "strata lab mis --out plates.png",
       "strata lab quadrature --samples 4096 --csv", "strata lab all --out figures"},
      [options](Console& console) { return RunLab(*options, console); });
  command
      ->add_option("NAME", options->name,
                   "An experiment; 'list' says what each does, 'all' runs them one by one")
      ->required();
  command->add_option("--seed", options->settings.seed, "Of all random numbers (0)");
  command
      ->add_option("--samples", options->settings.samples,
                   "How many; what they are depends on the experiment, as docs/lab.md says")
      ->check(CLI::Range(int64_t{2}, int64_t{1} << 30));
  command->add_flag("--csv", options->csv, "Print comma-separated values");
  command->add_flag("--markdown", options->markdown, "Print a section of Markdown");
  command
      ->add_option("--out", options->out,
                   "Write the plot (.png, .svg; needs gnuplot) or picture (.png, .exr) there")
      ->type_name("FILE");
}

}  // namespace strata
