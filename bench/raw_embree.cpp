// Raw Embree rays per second on the rays of a scene's paths, beside what Geometry makes of them.

#include "bench/raw_embree.h"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "worker/pbrt/reader.h"
#include "worker/scene/file_source.h"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;

struct Row {
  std::string scene;
  int threads = 1;
  uint64_t triangles = 0;
  double build_s = 0;
  RawEmbreeRates raw;
  double intersect = 0;  ///< Geometry::Intersect, millions of rays per second.
  double surface = 0;    ///< The same with Geometry::Surface for each hit.
};

Ray ToRay(const RTCRay& ray) {
  return {{ray.org_x, ray.org_y, ray.org_z}, {ray.dir_x, ray.dir_y, ray.dir_z}, ray.tfar};
}

absl::StatusOr<std::vector<Row>> Measure(const std::string& path, const std::vector<int>& threads,
                                         double seconds, int paths) {
  const std::filesystem::path file = std::filesystem::absolute(path);
  const DirectorySource source(file.parent_path());
  STRATA_ASSIGN_OR_RETURN(const PbrtScene scene, ReadPbrt(source, file.filename().string()));
  const Clock::time_point start = Clock::now();
  STRATA_ASSIGN_OR_RETURN(const std::unique_ptr<Geometry> geometry, Geometry::Build(scene.scene));
  const double build_s = std::chrono::duration<double>(Clock::now() - start).count();
  const RecordedRays rays = RecordRays(*geometry, scene.scene.camera, paths);
  std::vector<Row> rows;
  for (const int count : threads) {
    Row row;
    row.scene = file.parent_path().filename().string();
    row.threads = count;
    row.triangles = geometry->triangle_count();
    row.build_s = build_s;
    row.raw = MeasureRawEmbree(*geometry, rays, count, seconds);
    row.intersect =
        raw_embree_detail::Rate(rays.closest, count, seconds, [&](const RTCRay& recorded) {
          Hit hit;
          geometry->Intersect(ToRay(recorded), &hit);
        });
    std::atomic<int> invalid{0};
    row.surface =
        raw_embree_detail::Rate(rays.closest, count, seconds, [&](const RTCRay& recorded) {
          const Ray ray = ToRay(recorded);
          Hit hit;
          if (!geometry->Intersect(ray, &hit)) return;
          const SurfacePoint point = geometry->Surface(ray, hit);
          if (!(point.ns.x <= 2)) ++invalid;  // Keeps the compiler from dropping the call.
        });
    rows.push_back(row);
  }
  return rows;
}

nlohmann::json ToJson(const Row& row) {
  return {{"scene", row.scene},
          {"threads", row.threads},
          {"triangles", row.triangles},
          {"build_s", row.build_s},
          {"embree_closest_mrays", row.raw.closest},
          {"embree_occlusion_mrays", row.raw.occlusion},
          {"intersect_mrays", row.intersect},
          {"intersect_surface_mrays", row.surface}};
}

int Run(int argc, char** argv) {
  CLI::App app("Raw Embree rays per second inside pbrt-v4 scenes, one ray at a time.");
  std::vector<std::string> scenes;
  std::vector<int> threads = {1, 2};
  double seconds = 1;
  int paths = 200000;
  bool json = false;
  app.add_option("SCENE", scenes, "pbrt-v4 files")->required();
  app.add_option("--threads", threads, "Thread counts")->capture_default_str();
  app.add_option("--seconds", seconds, "Seconds for each figure")->capture_default_str();
  app.add_option("--paths", paths, "Paths whose rays are recorded")->capture_default_str();
  app.add_flag("--json", json, "One JSON object per line");
  CLI11_PARSE(app, argc, argv);

  if (!json)
    std::printf("%-20s %7s %10s %8s | %s\n%-20s %7s %10s %8s | %9s %9s %10s %10s\n", "", "", "", "",
                "millions of rays per second", "scene", "threads", "triangles", "build s",
                "closest", "occlusion", "Intersect", "+ Surface");
  for (const std::string& scene : scenes) {
    const absl::StatusOr<std::vector<Row>> rows = Measure(scene, threads, seconds, paths);
    if (!rows.ok()) {
      std::fprintf(stderr, "%s\n", std::string(rows.status().message()).c_str());
      return 2;
    }
    for (const Row& row : *rows) {
      if (json) {
        std::printf("%s\n", ToJson(row).dump().c_str());
      } else {
        std::printf("%-20s %7d %10llu %8.3f | %9.2f %9.2f %10.2f %10.2f\n", row.scene.c_str(),
                    row.threads, static_cast<unsigned long long>(row.triangles), row.build_s,
                    row.raw.closest, row.raw.occlusion, row.intersect, row.surface);
      }
    }
  }
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Run(argc, argv); }
