#include <memory>

#include "cli/commands.h"
#include "cli/diff_report.h"
#include "common/image_file.h"

namespace strata {
namespace {

struct DiffOptions {
  std::string a, b;
  bool json = false;
};

absl::StatusOr<DiffImage> ReadImage(const std::string& path) {
  absl::StatusOr<ImageLayers> layers = ReadExr(path);
  if (!layers.ok()) return AsBadInput(layers.status());
  return DiffImage{path, *std::move(layers)};
}

absl::StatusOr<ExitStatus> RunDiff(const DiffOptions& options, Console& console) {
  STRATA_ASSIGN_OR_RETURN(const DiffImage a, ReadImage(options.a));
  STRATA_ASSIGN_OR_RETURN(const DiffImage b, ReadImage(options.b));
  STRATA_ASSIGN_OR_RETURN(const ImageDifference difference,
                          CompareImages(a.layers, a.path, b.layers, b.path));
  const std::vector<std::string> warnings = DiffWarnings(a, b, difference);
  for (const std::string& warning : warnings) console.Warning(warning);
  if (options.json) {
    console.Result(DiffEvent(a, b, difference, warnings));
  } else {
    for (const std::string& line : DiffLines(a, b, difference)) console.Result(line);
  }
  return difference.verdict == Verdict::kDisagree ? ExitStatus::kFailed : ExitStatus::kDone;
}

}  // namespace

void AddDiffCommand(CommandLine& commands) {
  const auto options = std::make_shared<DiffOptions>();
  CLI::App* command = commands.Add(
      "diff", "Compare two images, and test whether they agree within their standard errors",
      {"strata diff new.exr reference.exr", "strata diff new.exr reference.exr --json"},
      [options](Console& console) { return RunDiff(*options, console); });
  command->add_option("A", options->a, "The image in question, OpenEXR")->required();
  command->add_option("B", options->b, "The reference")->required();
  command->add_flag("--json", options->json, "Print a JSON object");
}

}  // namespace strata
