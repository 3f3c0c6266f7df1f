// What techniques are worth: variance, cost and efficiency of whole frames with each technique of
// light sampling and without it, by each strategy, and by each kind of roulette.

#include <absl/strings/numbers.h>
#include <absl/strings/strip.h>
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <utility>
#include <vector>

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
      {"near rectangles by area", {.solid_angle = false}},
      {"quads as two triangles", {.quads = false}},
      {"environment by luminance", {.compensate = false}},
      {"no guide to mirrored lamps", {.mirrors = false}},
      {"one kernel for all scenes", {.least_kernel = false}},
      {"small scenes by a hierarchy", {.few_triangles = false}},
  };
  return techniques;
}

/// The same numbers anywhere.
class Uniform {
 public:
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(random_() >> 8) * 0x1p-24f;
  }

 private:
  std::mt19937 random_{1};
};

SceneDescription GrayScene() {
  SceneDescription scene;
  scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
  scene.materials.push_back(DiffuseMaterial{0});
  return scene;
}

void AddBox(SceneDescription* scene, Vec3f low, Vec3f high) {
  TriangleMeshShape box;
  for (int i = 0; i < 8; ++i)
    box.positions.push_back(
        {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  box.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  scene->shapes.emplace_back().geometry = box;
}

/// A closed room with `boxes` on its floor and in the air, lit by a lamp of two triangles: 12 for
/// the room and each box.
SceneDescription RoomOfBoxes(int boxes) {
  Uniform uniform;
  SceneDescription scene = GrayScene();
  AddBox(&scene, {-1, -1, -1}, {1, 1, 1});
  for (int i = 0; i < boxes; ++i) {
    const Vec3f size = {uniform(0.1f, 0.4f), uniform(0.1f, 0.4f), uniform(0.1f, 0.4f)};
    const Vec3f at = {uniform(-0.9f, 0.5f), uniform(-0.4f, 0.5f), uniform(-1, 0.3f)};
    AddBox(&scene, at, at + size);
  }
  TriangleMeshShape lamp;
  lamp.positions = {
      {-0.3f, -0.3f, 0.99f}, {-0.3f, 0.3f, 0.99f}, {0.3f, 0.3f, 0.99f}, {0.3f, -0.3f, 0.99f}};
  lamp.triangles = {{0, 1, 2}, {0, 2, 3}};
  ShapeDescription& shape = scene.shapes.emplace_back();
  shape.geometry = lamp;
  shape.emission = AreaEmission{Rgb::Gray(10)};
  scene.camera.camera_to_world =
      *Transform::LookAt({0, -0.95, 0}, {0, 0, -0.2}, {0, 0, 1})->Inverse();
  scene.camera.fov = 70;
  scene.defaults.max_depth = 12;
  return scene;
}

/// A hall of 200 x 200 x 5 metres, with shelves, under 10,000 small lamps of many strengths that
/// shine down and a little aside. The camera looks at the floor: lamps in view are noise that no
/// way of choosing among them removes.
SceneDescription ManyLights() {
  Uniform uniform;
  SceneDescription scene = GrayScene();
  AddBox(&scene, {-100, -100, 0}, {100, 100, 5});
  for (int i = 0; i < 2000; ++i) {
    const Vec3f at = {uniform(-99, 99), uniform(-99, 99), 0};
    AddBox(&scene, at, at + Vec3f{uniform(0.2f, 2), uniform(0.2f, 2), uniform(0.2f, 3)});
  }
  for (int i = 0; i < 10000; ++i) {
    TriangleMeshShape lamp;
    lamp.positions = {{-0.05f, -0.05f, 0}, {0, 0.05f, 0}, {0.05f, -0.05f, 0}};
    lamp.triangles = {{0, 1, 2}};
    ShapeDescription shape;
    shape.geometry = lamp;
    const float x = uniform(-99, 99), y = uniform(-99, 99), z = uniform(4, 4.9f);
    const float degrees = uniform(-40, 40), across = uniform(-1, 1), along = uniform(-1, 1);
    shape.to_world = Transform::Translate(x, y, z) * Transform::Rotate(degrees, across, along, 0);
    const float strength = uniform(0, 1);
    shape.emission = AreaEmission{Rgb{uniform(0.5f, 1), uniform(0.5f, 1), uniform(0.5f, 1)} *
                                  (2000 * strength * strength)};
    scene.shapes.push_back(std::move(shape));
  }
  scene.camera.camera_to_world =
      *Transform::LookAt({-9, -8, 3.9}, {-3, -3, 0}, {0, 0, 1})->Inverse();
  scene.camera.fov = 60;
  return scene;
}

absl::StatusOr<std::shared_ptr<const Scene>> LoadWith(const std::string& path,
                                                      const BuildOptions& build) {
  int boxes = 0;
  if (absl::SimpleAtoi(absl::StripPrefix(path, "room-"), &boxes) && path.starts_with("room-"))
    return Scene::Build(RoomOfBoxes(boxes), DirectorySource("."), build);
  if (path == "many-lights") return Scene::Build(ManyLights(), DirectorySource("."), build);
  const std::filesystem::path file = std::filesystem::absolute(path);
  return LoadScene(DirectorySource(file.parent_path()), file.filename().string(), build);
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
    STRATA_ASSIGN_OR_RETURN(const auto scene, LoadWith(path, technique.build));
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
  app.add_option("scenes", scenes,
                 "pbrt files, \"many-lights\": 10,000 of them, or \"room-N\": with N boxes")
      ->required();
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
