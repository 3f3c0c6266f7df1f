#include <memory>

#include "cli/commands.h"
#include "cli/farm_address.h"
#include "cli/format.h"

namespace strata {
namespace {

struct ControlOptions {
  FarmAddress farm;
  JobId job;
  int priority = 0;
  bool json = false;
};

/// What a command does to a job.
using Control = absl::Status (FarmClient::*)(const JobId&);

void AddControl(CommandLine& commands, const std::string& name, const std::string& summary,
                const std::string& done, Control control) {
  const auto options = std::make_shared<ControlOptions>();
  CLI::App* command = commands.Add(
      name, summary, {"strata " + name + " j-1", "STRATA_SERVER=farm:7447 strata " + name + " j-1"},
      [options, done, control](Console& console) {
        return WithFarm(options->farm, [&](FarmClient& farm) -> absl::StatusOr<ExitStatus> {
          STRATA_RETURN_IF_ERROR((farm.*control)(options->job));
          console.Note(Printable(options->job) + " " + done);
          return ExitStatus::kDone;
        });
      });
  command->add_option("JOB", options->job, "The job, as 'strata jobs' names it")->required();
  AddFarmAddress(command, options->farm);
}

}  // namespace

void AddControlCommands(CommandLine& commands) {
  AddControl(commands, "cancel", "Stop a job for good; what is merged can still be fetched",
             "is cancelled", &FarmClient::Cancel);
  AddControl(commands, "pause", "Hand out no more work of a job", "is paused", &FarmClient::Pause);
  AddControl(commands, "resume", "Go on with a paused job", "goes on", &FarmClient::Resume);
  AddControl(commands, "retry", "Start a failed or cancelled job again, keeping what is merged",
             "starts again", &FarmClient::Retry);
  AddControl(commands, "delete", "Forget a job that has ended, and its image", "is deleted",
             &FarmClient::Delete);

  const auto options = std::make_shared<ControlOptions>();
  CLI::App* set = commands.Add(
      "set", "Change the priority of a job",
      {"strata set j-1 --priority 10", "strata set j-2 --priority -5"},
      [options](Console& console) {
        return WithFarm(options->farm, [&](FarmClient& farm) -> absl::StatusOr<ExitStatus> {
          STRATA_RETURN_IF_ERROR(farm.SetPriority(options->job, options->priority));
          console.Note(absl::StrCat(Printable(options->job), " has priority ", options->priority));
          return ExitStatus::kDone;
        });
      });
  set->add_option("JOB", options->job, "The job, as 'strata jobs' names it")->required();
  set->add_option("--priority", options->priority, "-100 to 100, higher first")
      ->type_name("P")
      ->required();
  AddFarmAddress(set, options->farm);
}

}  // namespace strata
