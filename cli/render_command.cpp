#include <memory>
#include <thread>

#include "cli/commands.h"
#include "cli/job_options.h"
#include "cli/local_farm.h"
#include "cli/run_job.h"

namespace strata {
namespace {

struct RenderOptions {
  JobOptions job;
  ImageOutput output;
  ProgressStyle style;
  int workers = 1;
  int threads = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
};

absl::StatusOr<ExitStatus> Render(const RenderOptions& options, Console& console) {
  STRATA_RETURN_IF_ERROR(CheckImageOutput(options.output));
  STRATA_ASSIGN_OR_RETURN(const ResolvedJob job, ResolveJob(options.job));
  ShowNotes(job, options.style.quiet, console);
  if (options.output.path.empty() && !options.style.quiet) {
    console.Note("no -o was given: the image will not be kept");
  }
  // From here on there are files to be removed, so an interrupt must come through here.
  const InterruptWatch interrupts;
  STRATA_ASSIGN_OR_RETURN(const std::unique_ptr<LocalFarm> farm,
                          LocalFarm::Start(options.workers, options.threads));
  STRATA_ASSIGN_OR_RETURN(const JobId id, SubmitJob(farm->client(), job, options.style, console));
  return FollowToEnd(farm->client(), id, options.output, options.style, interrupts,
                     OnInterrupt::kCancel, console);
}

}  // namespace

void AddRenderCommand(CommandLine& commands) {
  const auto options = std::make_shared<RenderOptions>();
  CLI::App* command = commands.Add(
      "render", "Render a scene on this machine",
      {"strata render scene.pbrt -o out.exr", "strata render scene.pbrt -o out.exr --png --spp 256",
       "strata render scene.pbrt -o crop.exr --crop 0,0,64,64 --channels albedo,normal"},
      [options](Console& console) { return Render(*options, console); });
  AddJobOptions(command, options->job);
  AddOutputOptions(command, options->output);
  AddProgressOptions(command, options->style);
  const std::string group = "This machine";
  command->add_option("--workers", options->workers, "Workers in this process")
      ->type_name("W")
      ->check(CLI::Range(1, 256))
      ->capture_default_str()
      ->group(group);
  command->add_option("--threads", options->threads, "Threads of each worker (default: all cores)")
      ->type_name("T")
      ->check(CLI::Range(1, 4096))
      ->group(group);
}

}  // namespace strata
