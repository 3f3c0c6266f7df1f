#include <absl/strings/str_format.h>

#include <memory>

#include "cli/commands.h"
#include "cli/events.h"
#include "cli/farm_address.h"
#include "cli/format.h"

namespace strata {
namespace {

struct ListOptions {
  FarmAddress farm;
  JobId job;  ///< For logs.
  bool json = false;
};

Table JobsTable(const std::vector<JobStatus>& jobs) {
  Table table({{"JOB"},
               {"NAME"},
               {"STATE"},
               {"PRIORITY", true},
               {"DONE", true},
               {"ERROR", true},
               {"SAMPLES/S", true},
               {"LEFT", true},
               {"WORKERS", true}});
  for (const JobStatus& job : jobs) {
    const bool ends = IsFinal(job.state);
    table.Add({Printable(job.id), Printable(job.spec.name), std::string(ToString(job.state)),
               absl::StrCat(job.spec.priority),
               absl::StrFormat("%d %%", static_cast<int>(100 * job.fraction)),
               job.rel_error > 0 ? FormatPercent(job.rel_error) : "-",
               ends ? "-" : FormatCount(job.samples_per_second),
               ends || job.eta_s < 0 ? "-" : FormatDuration(job.eta_s), absl::StrCat(job.workers)});
  }
  return table;
}

Table WorkersTable(const std::vector<WorkerStatus>& workers) {
  Table table({{"WORKER"},
               {"NAME"},
               {"STATE"},
               {"THREADS", true},
               {"LEASES", true},
               {"SAMPLES", true},
               {"CONNECTED", true},
               {"SILENT", true},
               {"TAGS"},
               {"BUILD"}});
  for (const WorkerStatus& worker : workers) {
    std::string tags;
    for (const std::string& tag : worker.tags) {
      absl::StrAppend(&tags, tags.empty() ? "" : ",", Printable(tag));
    }
    table.Add({Printable(worker.id), Printable(worker.name), Printable(worker.state),
               absl::StrCat(worker.threads), absl::StrCat(worker.leases),
               FormatCount(static_cast<double>(worker.samples)), FormatDuration(worker.connected_s),
               FormatDuration(worker.silent_s), tags.empty() ? "-" : tags,
               Printable(worker.build)});
  }
  return table;
}

absl::StatusOr<ExitStatus> ListJobs(FarmClient& farm, const ListOptions& options,
                                    Console& console) {
  STRATA_ASSIGN_OR_RETURN(const std::vector<JobStatus> jobs, farm.List());
  if (options.json) {
    console.Result(JobsJson(jobs));
  } else {
    for (const std::string& line : JobsTable(jobs).Lines()) console.Result(line);
  }
  return ExitStatus::kDone;
}

absl::StatusOr<ExitStatus> ListWorkers(FarmClient& farm, const ListOptions& options,
                                       Console& console) {
  STRATA_ASSIGN_OR_RETURN(const std::vector<WorkerStatus> workers, farm.Workers());
  if (options.json) {
    console.Result(WorkersJson(workers));
  } else {
    for (const std::string& line : WorkersTable(workers).Lines()) console.Result(line);
  }
  return ExitStatus::kDone;
}

absl::StatusOr<ExitStatus> ShowLogs(FarmClient& farm, const ListOptions& options,
                                    Console& console) {
  STRATA_ASSIGN_OR_RETURN(const std::vector<LogLine> lines, farm.Logs(options.job));
  if (options.json) {
    console.Result(LogsJson(lines));
    return ExitStatus::kDone;
  }
  for (const LogLine& line : lines) {
    console.Result(absl::StrFormat("%s %-7s %s", FormatTime(line.unix_s), Printable(line.level),
                                   Printable(line.text)));
  }
  return ExitStatus::kDone;
}

using List = absl::StatusOr<ExitStatus> (*)(FarmClient&, const ListOptions&, Console&);

CLI::App* AddList(CommandLine& commands, const std::string& name, const std::string& summary,
                  const std::vector<std::string>& examples, List list,
                  const std::shared_ptr<ListOptions>& options) {
  CLI::App* command = commands.Add(name, summary, examples, [options, list](Console& console) {
    return WithFarm(options->farm, [&](FarmClient& farm) { return list(farm, *options, console); });
  });
  command->add_flag("--json", options->json, "Print a JSON array");
  AddFarmAddress(command, options->farm);
  return command;
}

}  // namespace

void AddListCommands(CommandLine& commands) {
  AddList(commands, "jobs", "List the jobs of a farm",
          {"strata jobs", "strata jobs --json | jq '.[].job'"}, ListJobs,
          std::make_shared<ListOptions>());
  AddList(commands, "workers", "List the workers of a farm",
          {"strata workers", "strata workers --server farm.example.org:7447 --insecure"},
          ListWorkers, std::make_shared<ListOptions>());
  const auto options = std::make_shared<ListOptions>();
  AddList(commands, "logs", "Show what happened to a job",
          {"strata logs j-1", "strata logs j-1 --json"}, ShowLogs, options)
      ->add_option("JOB", options->job, "The job, as 'strata jobs' names it")
      ->required();
}

}  // namespace strata
