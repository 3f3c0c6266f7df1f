#include <memory>

#include "cli/commands.h"
#include "cli/farm_address.h"
#include "cli/format.h"
#include "cli/interrupt.h"
#include "cli/json.h"
#include "cli/report.h"

namespace strata {
namespace {

struct FetchOptions {
  FarmAddress farm;
  JobId job;
  ImageOutput output;
  bool json = false;
};

absl::StatusOr<ExitStatus> Fetch(FarmClient& farm, const FetchOptions& options, Console& console) {
  STRATA_ASSIGN_OR_RETURN(const JobStatus status, farm.Get(options.job));
  STRATA_ASSIGN_OR_RETURN(const ImageLayers image, farm.FetchImage(options.job));
  // Ctrl-C waits until the files are whole.
  const InterruptWatch interrupts;
  STRATA_ASSIGN_OR_RETURN(const std::vector<std::string> files, WriteImage(options.output, image));
  if (options.json) {
    console.Result(Json{
        {"job", options.job},
        {"final", IsFinal(status.state)},
        {"fraction", status.fraction},
        {"files",
         files}}.dump());
    return ExitStatus::kDone;
  }
  for (const std::string& file : files) console.Result(file);
  if (!IsFinal(status.state)) {
    console.Note(absl::StrCat("image so far: ", FormatPercent(status.fraction), " of the samples"));
  }
  return ExitStatus::kDone;
}

}  // namespace

void AddFetchCommand(CommandLine& commands) {
  const auto options = std::make_shared<FetchOptions>();
  CLI::App* command = commands.Add(
      "fetch", "Get the image of a job, final or so far",
      {"strata fetch j-1 -o out.exr", "strata fetch j-1 -o out.exr --png",
       "strata fetch j-1 -o look.png"},
      [options](Console& console) -> absl::StatusOr<ExitStatus> {
        STRATA_RETURN_IF_ERROR(CheckImageOutput(options->output));
        return WithFarm(options->farm,
                        [&](FarmClient& farm) { return Fetch(farm, *options, console); });
      });
  command->add_option("JOB", options->job, "The job, as 'strata jobs' names it")->required();
  AddOutputOptions(command, options->output)->required();
  command->add_flag("--json", options->json, "Print a JSON object");
  AddFarmAddress(command, options->farm);
}

}  // namespace strata
