#include <absl/strings/str_format.h>
#include <malloc.h>
#include <unistd.h>

#include <fstream>
#include <memory>

#include "cli/commands.h"
#include "cli/format.h"
#include "cli/job_options.h"
#include "cli/json.h"
#include "cli/scene_summary.h"
#include "worker/integrator/render.h"

namespace strata {
namespace {

struct CheckOptions {
  JobOptions job;
  bool json = false;
};

/// All that is told of a scene.
struct CheckResult {
  JobSpec spec;
  SceneSummary summary;
  UnusedParts unused;
  uint64_t scene_bytes = 0;       ///< By which this process grew while it loaded the scene.
  int64_t background_pixels = 0;  ///< Renderer::BackgroundPixels.
  std::vector<std::string> notes, warnings;
};

/// Memory of this process that is resident now, in bytes; 0 where the system does not tell.
uint64_t ResidentBytes() {
  std::ifstream statm("/proc/self/statm");
  uint64_t size = 0, resident = 0;
  statm >> size >> resident;
  return resident * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Builds the scene as a worker would and throws it away: what a worker would stumble over, this
/// stumbles over. Sets what `result` says of it.
absl::Status BuildScene(const ScenePath& path, const JobSpec& spec, CheckResult* result) {
  malloc_trim(0);  // What was freed but kept would otherwise serve the scene, and not be counted.
  const uint64_t before = ResidentBytes();
  const absl::StatusOr<std::shared_ptr<const Scene>> scene =
      LoadScene(path.Source(), path.scene, {}, spec.bundle.options);
  if (!scene.ok()) {
    return absl::InvalidArgumentError(path.Located(std::string(scene.status().message())));
  }
  const uint64_t after = ResidentBytes();
  result->scene_bytes = after > before ? after - before : 0;
  STRATA_ASSIGN_OR_RETURN(const auto renderer, Renderer::Create(*scene, spec));
  result->background_pixels = renderer->BackgroundPixels();
  return absl::OkStatus();
}

absl::StatusOr<CheckResult> CheckScene(const JobOptions& options) {
  STRATA_ASSIGN_OR_RETURN(const LoadedScene loaded, ReadScene(options));
  STRATA_ASSIGN_OR_RETURN(ResolvedJob job, ResolveJob(options, loaded));
  CheckResult result;
  result.summary = Summarize(loaded.file.scene);
  result.unused = loaded.file.unused;
  result.summary.files = job.spec.bundle.files.size();
  for (const BundleFile& file : job.spec.bundle.files) result.summary.file_bytes += file.bytes;
  STRATA_RETURN_IF_ERROR(BuildScene(loaded.path, job.spec, &result));
  result.spec = std::move(job.spec);
  result.notes = std::move(job.notes);
  result.warnings = std::move(job.warnings);
  return result;
}

/// "3 diffuse, 1 conductor"
std::string CountsLine(const SceneSummary::Counts& counts) {
  std::string line;
  for (const auto& [kind, count] : counts) {
    absl::StrAppend(&line, line.empty() ? "" : ", ", count, " ", kind);
  }
  return line.empty() ? "none" : line;
}

void PrintLines(const CheckResult& result, Console& console) {
  const SceneSummary& summary = result.summary;
  const JobSpec& spec = result.spec;
  Table table({{"WHAT"}, {"IN THE SCENE"}});
  table.Add({"frame", absl::StrFormat("%d x %d, pixels %d,%d to %d,%d", spec.width, spec.height,
                                      spec.crop.x0, spec.crop.y0, spec.crop.x1, spec.crop.y1)});
  table.Add({"sampling", absl::StrFormat("%d samples per pixel, depth %d, %s, %s filter", spec.spp,
                                         spec.max_depth, ToString(spec.sampler).data(),
                                         ToString(spec.filter.kind).data())});
  table.Add({"shapes", CountsLine(summary.shapes)});
  table.Add({"triangles", absl::StrFormat("%d, %d with instances", summary.triangles,
                                          summary.instanced_triangles)});
  if (summary.instances > 0) {
    table.Add(
        {"instances", absl::StrFormat("%d of %d objects", summary.instances, summary.objects)});
  }
  table.Add({"materials", CountsLine(summary.materials)});
  table.Add({"lights", CountsLine(summary.lights)});
  table.Add({"textures", CountsLine(summary.textures)});
  table.Add({"files", absl::StrFormat("%d, %s", summary.files,
                                      FormatBytes(static_cast<double>(summary.file_bytes)))});
  table.Add({"memory", absl::StrFormat("film %s at the coordinator, scene %s at each worker",
                                       FormatBytes(static_cast<double>(FilmBytes(spec))),
                                       FormatBytes(static_cast<double>(result.scene_bytes)))});
  for (const std::string& line : table.Lines()) console.Result(line);
  for (const std::string& note : result.notes) console.Note(note);
  if (result.background_pixels > 0) {
    console.Note(BackgroundLine(result.background_pixels, spec.crop.Pixels()));
  }
  for (const std::string& warning : result.warnings) console.Warning(warning);
  console.Result(result.warnings.empty()
                     ? std::string("everything is supported")
                     : absl::StrCat(result.warnings.size(),
                                    " warnings: it renders, but not quite as the file asks"));
}

void PrintJson(const CheckResult& result, Console& console) {
  const SceneSummary& summary = result.summary;
  const JobSpec& spec = result.spec;
  console.Result(Json{{"scene", spec.bundle.scene},
                      {"scene_digest", BundleDigest(spec.bundle).ToString()},
                      {"width", spec.width},
                      {"height", spec.height},
                      {"crop", {spec.crop.x0, spec.crop.y0, spec.crop.x1, spec.crop.y1}},
                      {"spp", spec.spp},
                      {"max_depth", spec.max_depth},
                      {"sampler", std::string(ToString(spec.sampler))},
                      {"filter", std::string(ToString(spec.filter.kind))},
                      {"shapes", summary.shapes},
                      {"triangles", summary.triangles},
                      {"instanced_triangles", summary.instanced_triangles},
                      {"objects", summary.objects},
                      {"instances", summary.instances},
                      {"materials", summary.materials},
                      {"lights", summary.lights},
                      {"textures", summary.textures},
                      {"files", summary.files},
                      {"file_bytes", summary.file_bytes},
                      {"background_pixels", result.background_pixels},
                      {"unused",
                       {{"objects", result.unused.objects},
                        {"materials", result.unused.materials},
                        {"textures", result.unused.textures},
                        {"images", result.unused.images}}},
                      {"film_bytes", FilmBytes(spec)},
                      {"scene_bytes", result.scene_bytes},
                      {"notes", result.notes},
                      {"warnings", result.warnings}}
                     .dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace

void AddCheckCommand(CommandLine& commands) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command = commands.Add(
      "check", "Say what a scene uses, what of it is not supported, and how large it is",
      {"strata check scene.pbrt", "strata check helmet.glb --env studio.exr",
       "strata check scenes/room/scene.pbrt --root scenes --json"},
      [options](Console& console) -> absl::StatusOr<ExitStatus> {
        STRATA_ASSIGN_OR_RETURN(const CheckResult result, CheckScene(options->job));
        if (options->json) {
          PrintJson(result, console);
        } else {
          PrintLines(result, console);
        }
        return ExitStatus::kDone;
      });
  AddJobOptions(command, options->job);
  command->add_flag("--json", options->json, "Print a JSON object");
}

}  // namespace strata
