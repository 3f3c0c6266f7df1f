#include <functional>
#include <memory>

#include "cli/commands.h"
#include "cli/events.h"
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
using Control = std::function<absl::Status(FarmClient&, const ControlOptions&)>;

Control Calls(absl::Status (FarmClient::*call)(const JobId&)) {
  return
      [call](FarmClient& farm, const ControlOptions& options) { return (farm.*call)(options.job); };
}

/// The job as it stands after `control`, for scripts.
absl::StatusOr<std::string> Outcome(FarmClient& farm, const JobId& job) {
  const absl::StatusOr<JobStatus> status = farm.Get(job);
  if (absl::IsNotFound(status.status())) return DeletedJson(job);
  STRATA_RETURN_IF_ERROR(status.status());
  return ControlJson(*status);
}

/// `done` follows the job's name in what people read.
CLI::App* AddControl(CommandLine& commands, const std::string& name, const std::string& summary,
                     const std::vector<std::string>& examples,
                     const std::shared_ptr<ControlOptions>& options, const Control& control,
                     const std::function<std::string()>& done) {
  CLI::App* command =
      commands.Add(name, summary, examples, [options, control, done](Console& console) {
        return WithFarm(options->farm, [&](FarmClient& farm) -> absl::StatusOr<ExitStatus> {
          STRATA_RETURN_IF_ERROR(control(farm, *options));
          if (!options->json) {
            console.Note(Printable(options->job) + " " + done());
            return ExitStatus::kDone;
          }
          STRATA_ASSIGN_OR_RETURN(const std::string outcome, Outcome(farm, options->job));
          console.Result(outcome);
          return ExitStatus::kDone;
        });
      });
  command->add_option("JOB", options->job, "The job, as 'strata jobs' names it")->required();
  command->add_flag("--json", options->json, "Print a JSON object");
  AddFarmAddress(command, options->farm);
  return command;
}

}  // namespace

void AddControlCommands(CommandLine& commands) {
  const auto add = [&](const std::string& name, const std::string& summary, const std::string& done,
                       const Control& control) {
    AddControl(commands, name, summary,
               {"strata " + name + " j-1", "STRATA_SERVER=farm:7447 strata " + name + " j-1"},
               std::make_shared<ControlOptions>(), control, [done] { return done; });
  };
  add("cancel", "Stop a job for good; what is merged can still be fetched", "is cancelled",
      Calls(&FarmClient::Cancel));
  add("pause", "Hand out no more work of a job", "is paused", Calls(&FarmClient::Pause));
  add("resume", "Go on with a paused job", "goes on", Calls(&FarmClient::Resume));
  add("retry", "Start a failed or cancelled job again, keeping what is merged", "starts again",
      Calls(&FarmClient::Retry));
  add("delete", "Forget a job that has ended, and its image", "is deleted",
      Calls(&FarmClient::Delete));

  const auto options = std::make_shared<ControlOptions>();
  AddControl(
      commands, "set", "Change the priority of a job",
      {"strata set j-1 --priority 10", "strata set j-2 --priority -5"}, options,
      [](FarmClient& farm, const ControlOptions& asked) {
        return farm.SetPriority(asked.job, asked.priority);
      },
      [options] { return absl::StrCat("has priority ", options->priority); })
      ->add_option("--priority", options->priority, "-100 to 100, higher first")
      ->type_name("P")
      ->required();
}

}  // namespace strata
