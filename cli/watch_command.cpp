#include <memory>

#include "cli/commands.h"
#include "cli/farm_address.h"
#include "cli/run_job.h"

namespace strata {
namespace {

struct WatchOptions {
  FarmAddress farm;
  JobId job;
  ImageOutput output;
  ProgressStyle style;
};

}  // namespace

void AddWatchCommand(CommandLine& commands) {
  const auto options = std::make_shared<WatchOptions>();
  CLI::App* command =
      commands.Add("watch", "Follow a job to its end",
                   {"strata watch j-1", "strata watch j-1 -o out.exr", "strata watch j-1 --json"},
                   [options](Console& console) -> absl::StatusOr<ExitStatus> {
                     STRATA_RETURN_IF_ERROR(CheckImageOutput(options->output));
                     const InterruptWatch interrupts;
                     return WithFarm(options->farm, [&](FarmClient& farm) {
                       return FollowToEnd(farm, options->job, options->output, options->style,
                                          interrupts, OnInterrupt::kDetach, console);
                     });
                   });
  command->add_option("JOB", options->job, "The job, as 'strata jobs' names it")->required();
  AddOutputOptions(command, options->output);
  AddProgressOptions(command, options->style);
  AddFarmAddress(command, options->farm);
}

}  // namespace strata
