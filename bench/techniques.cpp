// What techniques are worth: variance, cost and efficiency of whole frames with each technique of
// light sampling and without it, by each strategy, and by each kind of roulette.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "bench/scenes.h"
#include "bench/stopwatch.h"
#include "worker/integrator/render.h"
#include "worker/scene/scene.h"

namespace strata {
namespace {

struct Options {
  int size = 128;
  uint32_t spp = 64;
  int seeds = 8;
  int threads = 2;
  bool cpu = false;  ///< Seconds are of user CPU time.
};

struct Technique {
  const char* name;
  BuildOptions build;
  DirectStrategy strategy = DirectStrategy::kMis;
  RouletteKind roulette = RouletteKind::kThroughput;
};

/// The first is what is shipped.
using Table = std::vector<Technique>;

const Table& Strategies() {
  static const Table strategies = {
      {"mis", {}},
      {"light", {}, DirectStrategy::kLightOnly},
      {"bsdf", {}, DirectStrategy::kBsdfOnly},
      {"cosine", {}, DirectStrategy::kCosine},
      {"uniform", {}, DirectStrategy::kUniform},
  };
  return strategies;
}

const Table& Roulettes() {
  static const Table roulettes = {
      {"roulette by throughput", {}},
      {"off", {}, DirectStrategy::kMis, RouletteKind::kOff},
      {"by efficiency", {}, DirectStrategy::kMis, RouletteKind::kEfficiency},
  };
  return roulettes;
}

const Table& SceneTechniques() {
  static const Table techniques = {
      {"as shipped", {}},
      {"lights chosen by intensity", {.selection = LightSelection::kIntensity}},
      {"lights chosen uniformly", {.selection = LightSelection::kUniform}},
      {"near lamps by area", {.solid_angle = false}},
      {"quads as two triangles", {.quads = false}},
      {"spheres by area", {.sphere_cones = false}},
      {"environment by luminance", {.compensate = false}},
      {"no guide to mirrored lamps", {.mirrors = false}},
      {"no guide through balls of glass", {.balls = false}},
      {"scattered by the medium alone", {.near_lamps = false}},
      {"one kernel for all scenes", {.least_kernel = false}},
      {"small scenes by a hierarchy", {.few_triangles = false}},
  };
  return techniques;
}

/// Mean and variance over the seeds of the channels of one frame.
class Frames {
 public:
  void Add(const Partial& partial) {
    const size_t pixels = partial.samples.size();
    mean_.resize(pixels * 3);
    squares_.resize(pixels * 3);
    ++count_;
    for (size_t i = 0; i < mean_.size(); ++i) {
      const double* values = &partial.values[i / 3 * partial.layout.Doubles()];
      double x = 0;
      for (int r = 0; r < kReplicates; ++r)
        x += values[partial.layout.Mean(r, static_cast<int>(i % 3))] / kReplicates;
      const double deviation = x - mean_[i];
      mean_[i] += deviation / count_;
      squares_[i] += deviation * (x - mean_[i]);
    }
  }
  /// Mean over all channels of variance / (mean^2 + 0.01).
  double RelativeVariance() const {
    double sum = 0;
    for (size_t i = 0; i < mean_.size(); ++i)
      sum += squares_[i] / (count_ - 1) / (mean_[i] * mean_[i] + 0.01);
    return sum / static_cast<double>(mean_.size());
  }

 private:
  double count_ = 0;
  std::vector<double> mean_, squares_;
};

struct Row {
  double relmse = 0, seconds = 0;
  double spread = 0;  ///< Of the seconds: half of their range, over the median.
  double rays = 0;    ///< For each sample.
};

absl::StatusOr<std::vector<Row>> Measure(const std::string& path, const Table& table,
                                         const Options& options) {
  RenderPool pool(options.threads);
  std::vector<std::shared_ptr<const Scene>> scenes;
  for (const Technique& technique : table) {
    STRATA_ASSIGN_OR_RETURN(const auto scene, LoadBenchScene(path, technique.build));
    scenes.push_back(scene);
  }
  JobSpec spec;
  spec.bundle.scene = "scene.pbrt";
  spec.bundle.files = {{spec.bundle.scene, {}, 0}};
  spec.width = spec.height = options.size;
  spec.crop = {0, 0, options.size, options.size};
  spec.spp = options.spp;
  spec.max_depth = scenes[0]->defaults().max_depth;
  std::vector<Frames> frames(scenes.size());
  std::vector<double> rays(scenes.size());
  std::vector<std::vector<double>> seconds(scenes.size());
  for (int seed = 1; seed <= options.seeds; ++seed) {
    for (size_t i = 0; i < scenes.size(); ++i) {  // Side by side, so that noise is shared.
      spec.seed = static_cast<uint64_t>(seed);
      spec.strategy = table[i].strategy;
      spec.roulette = table[i].roulette;
      STRATA_ASSIGN_OR_RETURN(const auto renderer, Renderer::Create(scenes[i], spec));
      const Stopwatch stopwatch(options.cpu);
      STRATA_ASSIGN_OR_RETURN(
          const Partial partial,
          renderer->Render({{}, spec.crop, {{0, options.spp / kReplicates}}}, pool));
      seconds[i].push_back(stopwatch.Seconds());
      frames[i].Add(partial);
      for (const uint64_t n : partial.rays) rays[i] += static_cast<double>(n);
    }
  }
  std::vector<Row> rows;
  for (size_t i = 0; i < scenes.size(); ++i) {
    std::sort(seconds[i].begin(), seconds[i].end());
    const double samples = static_cast<double>(spec.crop.Pixels()) * options.spp * options.seeds;
    const double median = seconds[i][seconds[i].size() / 2];
    rows.push_back({frames[i].RelativeVariance(), median,
                    0.5 * (seconds[i].back() - seconds[i].front()) / median, rays[i] / samples});
  }
  return rows;
}

int Main(int argc, char** argv) {
  CLI::App app("Techniques one by one: variance, cost, efficiency");
  std::vector<std::string> scenes;
  Options options;
  app.add_option("scenes", scenes, kBenchScenes)->required();
  std::string table_name = "scene";
  app.add_option("--table", table_name, "what is compared")
      ->check(CLI::IsMember({"scene", "strategies", "roulette"}));
  app.add_option("--size", options.size, "edge of the square frame in pixels");
  app.add_option("--spp", options.spp, "samples per pixel, a multiple of 8");
  app.add_option("--seeds", options.seeds)->check(CLI::Range(2, 1 << 20));
  app.add_option("--threads", options.threads);
  app.add_flag("--cpu", options.cpu, "seconds are of user CPU time");
  CLI11_PARSE(app, argc, argv);
  const Table& table = table_name == "strategies" ? Strategies()
                       : table_name == "roulette" ? Roulettes()
                                                  : SceneTechniques();
  for (const std::string& path : scenes) {
    const auto rows = Measure(path, table, options);
    if (!rows.ok()) {
      std::fprintf(stderr, "%s\n", rows.status().ToString().c_str());
      return 2;
    }
    std::printf("%s\n  %-28s %12s %17s %12s %12s %12s\n", path.c_str(), "", "relMSE",
                options.cpu ? "CPU seconds" : "seconds", "efficiency", "rays/sample",
                "eff. by rays");
    const Row& shipped = rows->front();
    for (size_t i = 0; i < rows->size(); ++i) {
      const Row& row = (*rows)[i];
      std::printf("  %-28s %12.5g %10.4f +-%2.0f %% %12.3f %12.2f %12.3f\n", table[i].name,
                  row.relmse, row.seconds, 100 * row.spread,
                  shipped.relmse * shipped.seconds / (row.relmse * row.seconds), row.rays,
                  shipped.relmse * shipped.rays / (row.relmse * row.rays));
    }
    std::fflush(stdout);
  }
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Main(argc, argv); }
