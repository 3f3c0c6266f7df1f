#include <cstdlib>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"
#include "worker/pbrt/reader.h"
#include "worker/scene/file_source.h"

namespace strata::testing {
namespace {

std::filesystem::path SharedScenes() {
  const char* shared = std::getenv("STRATA_SHARED");
  return std::filesystem::path(shared ? shared : STRATA_SOURCE_DIR "/../shared") / "scenes" /
         "pbrt";
}

TEST(SharedScenes, MeshesTrace) {
  for (const char* name : {"cornell-box", "coffee", "classroom"}) {
    const std::filesystem::path folder = SharedScenes() / name;
    if (!std::filesystem::exists(folder / "scene.pbrt"))
      GTEST_SKIP() << "needs the shared scenes, " << folder << " is missing";
    const DirectorySource source(folder);
    const auto scene = ReadPbrt(source, "scene.pbrt");
    ASSERT_TRUE(scene.ok()) << scene.status();
    const auto geometry = MustBuild(scene->scene);
    EXPECT_GT(geometry->triangle_count(), 30u);
    EXPECT_FALSE(geometry->emitters().empty() && scene->scene.lights.empty());
    Random random(1);
    const Transform& camera = scene->scene.camera.camera_to_world;
    const Vec3d eye = camera.Point({});
    int hits = 0;
    for (int i = 0; i < 5000; ++i) {
      const Vec3d pixel = {Uniform(random, -0.2, 0.2), Uniform(random, -0.2, 0.2), 1};
      const Ray ray = MakeRay(eye, Normalize(camera.Vector(pixel)));
      Hit hit;
      if (!geometry->Intersect(ray, &hit)) continue;
      ++hits;
      const SurfacePoint point = geometry->Surface(ray, hit);
      ASSERT_TRUE(IsFinite(point.p) && IsFinite(point.ns) && IsFinite(point.dpdu));
      ASSERT_NEAR(Length(point.ns), 1, 1e-5);
      ASSERT_GE(Dot(point.ng, point.ns), 0);
      ASSERT_LT(point.light, static_cast<int32_t>(geometry->emitters().size()));
      const Vec3d along = ToDouble(ray.origin) + ToDouble(ray.direction) * hit.t;
      ASSERT_LT(Length(ToDouble(point.p) - along), 1e-4 * hit.t);
    }
    EXPECT_GT(hits, 3000) << name;
  }
}

}  // namespace
}  // namespace strata::testing
