// Samples and rays per second of whole renders, beside raw Embree's on the same scene.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "bench/embree_clock.h"
#include "bench/raw_embree.h"
#include "bench/scenes.h"
#include "worker/integrator/render.h"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Options {
  int size = 256;
  uint32_t spp = 64;
  int threads = 2;
  int repeats = 5;
  double raw_seconds = 0.5;
  KernelKind kernel = KernelKind::kFast;
};

/// Median, least and greatest of some runs.
struct Spread {
  double median = 0, min = 0, max = 0;
};

Spread SpreadOf(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return {values[values.size() / 2], values.front(), values.back()};
}

struct Row {
  std::string scene;
  double load_s = 0;
  Spread msamples, mrays;
  double rays_per_sample = 0;
  RawEmbreeRates raw;
  RawEmbreeRates cast;  ///< As the kernel casts rays.
  Spread outside_ns;    ///< Thread time per ray that is not spent in casting it; see README.md.
  Spread cast_share;    ///< Part of the time that is.
};

absl::StatusOr<Row> Measure(const std::string& path, const Options& options) {
  Row row;
  const std::filesystem::path file = std::filesystem::absolute(path);
  row.scene = file.has_extension() ? (file.parent_path().filename() / file.stem()).string() : path;
  const Clock::time_point load = Clock::now();
  STRATA_ASSIGN_OR_RETURN(const auto scene, LoadBenchScene(path));
  row.load_s = Since(load);

  JobSpec spec;
  spec.bundle.scene = file.filename().string();
  spec.bundle.files = {{spec.bundle.scene, {}, 0}};
  spec.width = spec.height = options.size;
  spec.crop = {0, 0, options.size, options.size};
  spec.spp = options.spp;
  spec.max_depth = scene->defaults().max_depth;
  spec.kernel = options.kernel;
  STRATA_ASSIGN_OR_RETURN(const auto renderer, Renderer::Create(scene, spec));
  RenderPool pool(options.threads);
  const double samples = static_cast<double>(spec.crop.Pixels()) * options.spp;
  std::vector<double> msamples, mrays, embree_share;
  for (int i = 0; i < options.repeats; ++i) {
    const Clock::time_point start = Clock::now();
    const EmbreeClock embree;
    STRATA_ASSIGN_OR_RETURN(
        const Partial partial,
        renderer->Render({{}, spec.crop, {{0, options.spp / kReplicates}}}, pool));
    const double inside = embree.Seconds(), seconds = Since(start);
    double rays = 0;
    for (uint64_t r : partial.rays) rays += static_cast<double>(r);
    msamples.push_back(samples / seconds * 1e-6);
    mrays.push_back(rays / seconds * 1e-6);
    embree_share.push_back(inside / (options.threads * seconds));
    row.rays_per_sample = rays / samples;
  }
  row.msamples = SpreadOf(msamples);
  row.mrays = SpreadOf(mrays);

  const RecordedRays rays = RecordRays(scene->geometry(), scene->camera(), 20000);
  row.raw = MeasureRawEmbree(scene->geometry(), rays, options.threads, options.raw_seconds);
  row.cast = options.kernel == KernelKind::kFast
                 ? MeasurePackets(scene->geometry(), rays, options.threads, options.raw_seconds)
                 : row.raw;
  // Small scenes are cast without Embree: there it is what the recorded rays cost, of which there
  // are about as many of each kind as of those of paths.
  const double closest = static_cast<double>(rays.closest.size());
  const double occlusion = static_cast<double>(rays.occlusion.size());
  const double cast_us =
      (closest / row.cast.closest + occlusion / row.cast.occlusion) / (closest + occlusion);
  std::vector<double> share, outside;
  for (size_t i = 0; i < mrays.size(); ++i) {
    share.push_back(embree_share[i] > 0 ? embree_share[i] : cast_us * mrays[i]);
    outside.push_back(1e3 * options.threads * (1 - share[i]) / mrays[i]);
  }
  row.cast_share = SpreadOf(share);
  row.outside_ns = SpreadOf(outside);
  return row;
}

nlohmann::json ToJson(const Row& row) {
  const auto spread = [](const Spread& s) {
    return nlohmann::json{{"median", s.median}, {"min", s.min}, {"max", s.max}};
  };
  return {{"scene", row.scene},
          {"load_s", row.load_s},
          {"msamples_per_s", spread(row.msamples)},
          {"mrays_per_s", spread(row.mrays)},
          {"rays_per_sample", row.rays_per_sample},
          {"raw_closest_mrays_per_s", row.raw.closest},
          {"raw_occlusion_mrays_per_s", row.raw.occlusion},
          {"cast_closest_mrays_per_s", row.cast.closest},
          {"cast_occlusion_mrays_per_s", row.cast.occlusion},
          {"outside_casting_ns_per_ray", spread(row.outside_ns)},
          {"casting_share", spread(row.cast_share)}};
}

/// The project's own scenes, then the shared ones: FOLDER/FILE.pbrt below either root.
std::vector<std::string> DefaultScenes() {
  std::vector<std::string> scenes;
  const std::filesystem::path source = STRATA_SOURCE_DIR;
  for (const std::filesystem::path& root :
       {source / "scenes", source / ".." / "shared" / "scenes" / "pbrt"}) {
    const auto first = static_cast<std::ptrdiff_t>(scenes.size());
    std::error_code error;
    for (const auto& folder : std::filesystem::directory_iterator(root, error)) {
      if (!folder.is_directory()) continue;
      for (const auto& file : std::filesystem::directory_iterator(folder.path()))
        if (file.path().extension() == ".pbrt")
          scenes.push_back(file.path().lexically_normal().string());
    }
    std::sort(scenes.begin() + first, scenes.end());
  }
  return scenes;
}

int Main(int argc, char** argv) {
  CLI::App app("Speed of the renderer: medians (min..max) of repeated renders");
  std::vector<std::string> scenes;
  Options options;
  bool json = false;
  app.add_option("scenes", scenes,
                 kBenchScenes + std::string("; default: our own and the shared ones"));
  app.add_option("--size", options.size, "edge of the square frame in pixels");
  app.add_option("--spp", options.spp, "samples per pixel, a multiple of 8");
  app.add_option("--threads", options.threads);
  app.add_option("--repeats", options.repeats);
  app.add_option("--raw-seconds", options.raw_seconds, "time for each rate of raw Embree");
  app.add_flag_callback(
      "--reference", [&] { options.kernel = KernelKind::kReference; }, "the reference kernel");
  app.add_flag("--json", json, "one object per line");
  CLI11_PARSE(app, argc, argv);
  if (scenes.empty()) scenes = DefaultScenes();
  if (!json)
    std::printf("%-25s %7s %22s %8s %9s %10s %10s %10s %10s %9s %7s\n", "scene", "load s",
                "Msamples/s", "Mrays/s", "rays/smp", "raw close", "raw occl", "cast close",
                "cast occl", "ns/ray", "casting");
  for (const std::string& path : scenes) {
    const auto row = Measure(path, options);
    if (!row.ok()) {
      std::fprintf(stderr, "%s\n", row.status().ToString().c_str());
      return 2;
    }
    if (json)
      std::printf("%s\n", ToJson(*row).dump().c_str());
    else
      std::printf(
          "%-25s %7.2f %7.3f (%5.3f..%5.3f) %8.2f %9.2f %10.2f %10.2f %10.2f %10.2f %9.0f "
          "%6.0f%%\n",
          row->scene.c_str(), row->load_s, row->msamples.median, row->msamples.min,
          row->msamples.max, row->mrays.median, row->rays_per_sample, row->raw.closest,
          row->raw.occlusion, row->cast.closest, row->cast.occlusion, row->outside_ns.median,
          100 * row->cast_share.median);
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Main(argc, argv); }
