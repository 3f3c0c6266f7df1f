#include <memory>

#include "cli/commands.h"
#include "cli/farm_address.h"
#include "cli/job_options.h"
#include "cli/run_job.h"

namespace strata {
namespace {

struct SubmitOptions {
  JobOptions job;
  FarmAddress farm;
  ImageOutput output;
  ProgressStyle style;
  bool watch = false;
};

absl::StatusOr<ExitStatus> Submit(const SubmitOptions& options, Console& console) {
  if (!options.output.path.empty() && !options.watch) {
    return absl::InvalidArgumentError(
        "strata submit: -o waits for the image, so it needs --watch; or use 'strata fetch' later");
  }
  STRATA_RETURN_IF_ERROR(CheckImageOutput(options.output));
  STRATA_ASSIGN_OR_RETURN(const ResolvedJob job, ResolveJob(options.job));
  ShowNotes(job, options.style.quiet, console);
  return WithFarm(options.farm, [&](FarmClient& farm) -> absl::StatusOr<ExitStatus> {
    STRATA_ASSIGN_OR_RETURN(const JobId id, SubmitJob(farm, job, options.style, console));
    const bool events = options.watch && options.style.json;
    if (!events) console.Result(options.style.json ? "{\"job\":\"" + id + "\"}" : id);
    if (!options.watch) return ExitStatus::kDone;
    const InterruptWatch interrupts;
    return FollowToEnd(farm, id, options.output, options.style, interrupts, OnInterrupt::kDetach,
                       console);
  });
}

}  // namespace

void AddSubmitCommand(CommandLine& commands) {
  const auto options = std::make_shared<SubmitOptions>();
  CLI::App* command = commands.Add(
      "submit", "Send a scene to a farm and print the job's id",
      {"strata submit scene.pbrt --spp 256", "strata submit scene.pbrt --watch -o out.exr --png",
       "strata submit scene.pbrt --priority 10 --server farm:7447 --insecure"},
      [options](Console& console) { return Submit(*options, console); });
  AddJobOptions(command, options->job);
  AddOutputOptions(command, options->output);
  AddProgressOptions(command, options->style);
  command->add_flag("--watch", options->watch, "Follow the job to its end");
  AddFarmAddress(command, options->farm);
}

}  // namespace strata
