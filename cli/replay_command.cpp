#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>

#include <memory>

#include "cli/commands.h"
#include "cli/job_options.h"
#include "worker/integrator/render.h"

namespace strata {
namespace {

struct ReplayOptions {
  JobOptions job;
  std::string pixel;
  uint32_t replicate = 0;
  uint32_t sample = 0;
};

absl::StatusOr<ExitStatus> Replay(const ReplayOptions& options, Console& console) {
  const std::vector<std::string> parts = absl::StrSplit(options.pixel, ',');
  int x = 0, y = 0;
  if (parts.size() != 2 || !absl::SimpleAtoi(parts[0], &x) || !absl::SimpleAtoi(parts[1], &y)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--pixel: '", options.pixel, "' is not understood, give X,Y such as 12,34"));
  }
  STRATA_ASSIGN_OR_RETURN(const ResolvedJob job, ResolveJob(options.job));
  // The job may have had another crop than the file, so any pixel of the frame will do.
  if (x < 0 || x >= job.spec.width || y < 0 || y >= job.spec.height) {
    return absl::InvalidArgumentError(absl::StrCat("--pixel: ", x, ",", y,
                                                   " is outside the frame, give 0,0 to ",
                                                   job.spec.width - 1, ",", job.spec.height - 1));
  }
  const DirectorySource source(job.root, job.elsewhere);
  const absl::StatusOr<std::shared_ptr<const Scene>> scene =
      LoadScene(source, job.spec.bundle.scene, {}, job.spec.bundle.options);
  if (!scene.ok()) return AsBadInput(scene.status());
  STRATA_ASSIGN_OR_RETURN(const std::unique_ptr<Renderer> renderer,
                          Renderer::Create(*scene, job.spec));
  console.Result(renderer->Replay(x, y, options.replicate, options.sample));
  return ExitStatus::kDone;
}

}  // namespace

void AddReplayCommand(CommandLine& commands) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* command =
      commands.Add("replay", "Trace one path of a job again and tell it vertex by vertex",
                   {"strata replay scene.pbrt --pixel 12,34 --replicate 0 --sample 5",
                    "strata replay scene.pbrt --pixel 12,34 --replicate 7 --sample 0 --seed 3"},
                   [options](Console& console) { return Replay(*options, console); });
  AddJobOptions(command, options->job);
  const std::string group = "Which path";
  command->add_option("--pixel", options->pixel, "The pixel, in the full frame")
      ->type_name("X,Y")
      ->required()
      ->group(group);
  command->add_option("--replicate", options->replicate, "0 to 7")
      ->type_name("R")
      ->check(CLI::Range(0, kReplicates - 1))
      ->required()
      ->group(group);
  command->add_option("--sample", options->sample, "Index in the replicate's sequence")
      ->type_name("I")
      ->check(CLI::NonNegativeNumber)
      ->required()
      ->group(group);
}

}  // namespace strata
