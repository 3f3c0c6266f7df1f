#include <gtest/gtest.h>

#include <cmath>

#include "tests/geometry/casters.h"
#include "tests/geometry/scene_builder.h"
#include "worker/geometry/few_triangles.h"
#include "worker/geometry/state.h"

// Scenes of few triangles, which packets meet without a hierarchy, against Embree's.

namespace strata::testing {
namespace {

/// A cube seen from within with a smaller one in it, turned and stretched; and a triangle
/// without area.
SceneDescription Room(const Transform& to_world) {
  SceneDescription scene = EmptyScene();
  scene.shapes.push_back(Shape(CubeMesh(), to_world));
  scene.shapes.push_back(Shape(CubeMesh(), to_world * Transform::Translate(0.2, -0.6, 0.1) *
                                               Transform::Rotate(30, 0, 1, 0) *
                                               Transform::Scale(0.3, 0.3, 0.3)));
  TriangleMeshShape line;
  line.positions = {{-0.5f, 0, 0}, {0, 0, 0}, {0.5f, 0, 0}};
  line.triangles = {{0, 1, 2}};
  scene.shapes.push_back(Shape(line, to_world));
  return scene;
}

TEST(FewTriangles, AreFoundWhereThereIsNothingElse) {
  const Transform to_world;
  EXPECT_FALSE(MustBuild(Room(to_world))->state().few.empty());
  SceneDescription with_sphere = Room(to_world);
  with_sphere.shapes.push_back(Shape(SphereShape{}));
  EXPECT_TRUE(MustBuild(with_sphere)->state().few.empty());
  SceneDescription with_instances = Room(to_world);
  with_instances.objects.push_back(ObjectOf({Shape(CubeMesh())}));
  with_instances.instances = {InstanceOf(0, to_world), InstanceOf(0, to_world)};
  EXPECT_TRUE(MustBuild(with_instances)->state().few.empty());
  SceneDescription many = EmptyScene();
  many.shapes.push_back(Shape(SphereMesh(10)));
  EXPECT_TRUE(MustBuild(many)->state().few.empty());
}

TEST(FewTriangles, MeetWhatEmbreeMeets) {
  constexpr int kRays = 40000;
  for (const double scale : {1e-12, 1e-4, 1.0, 1e3, 1e6, 1e9}) {
    Random random(11);
    const Transform to_world = RandomAffine(random, scale);
    const auto geometry = MustBuild(Room(to_world));
    ASSERT_FALSE(geometry->state().few.empty());
    int hits = 0, elsewhere = 0, blocked = 0, otherwise = 0;
    for (int i = 0; i < kRays; ++i) {
      const Vec3d from = to_world.Point(UnitVector(random) * Uniform(random, 0, 1.4));
      // Some rays are short, some of no unit length.
      Ray ray = MakeRay(from, UnitVector(random) * (i % 3 == 0 ? scale : 1.0));
      if (i % 2 == 0) ray.t_max = static_cast<float>((i % 3 == 0 ? 1 : scale) * Uniform(random));
      Hit expected, hit;
      const bool meets = geometry->Intersect(ray, &expected);
      EXPECT_EQ(geometry->Occluded(ray), meets);
      otherwise += InPackets::Occluded(*geometry, ray) != meets;
      blocked += meets;
      if (InPackets::Intersect(*geometry, ray, &hit) != meets) {
        ++elsewhere;
        continue;
      }
      if (!meets) continue;
      ++hits;
      if (hit.primitive != expected.primitive) {
        ++elsewhere;
        continue;
      }
      // Both round a handful of times, relative to how far corners are from the ray's origin, and
      // divide by the cosine. No triangle is lower than a fifth of the scale.
      const float grazing = AbsDot(geometry->Surface(ray, expected).ng, Normalize(ray.direction));
      const float tolerance = 16 * 0x1p-24f * static_cast<float>(8 * scale) / grazing;
      EXPECT_NEAR(hit.t, expected.t, tolerance / Length(ray.direction));
      EXPECT_NEAR(hit.u, expected.u, tolerance / (0.2 * scale));
      EXPECT_NEAR(hit.v, expected.v, tolerance / (0.2 * scale));
    }
    SCOPED_TRACE(scale);
    EXPECT_GT(hits, kRays / 2);
    EXPECT_GT(blocked, kRays / 2);
    // Of two triangles with a common edge either may be met there: within about 2^-21 of it.
    EXPECT_LE(elsewhere, 3);
    EXPECT_LE(otherwise, 3);
  }
}

TEST(FewTriangles, OnlyActiveLanesAreMet) {
  const auto geometry = MustBuild(Room({}));
  RayLanes rays = InPackets::PacketOf(MakeRay({0.1, 0.2, 0.1}, {0, 0, 1}));
  rays.direction.Set(5, {NAN, NAN, NAN});
  const MaskLanes active = {0, -1, 0, -1, 0, 0, 0, -1};
  HitLanes hits;
  EXPECT_EQ(Bits(Intersect(*geometry, rays, active, &hits)), Bits(active));
  EXPECT_EQ(Bits(Occluded(*geometry, rays, active)), Bits(active));
  EXPECT_NEAR(hits.t[3], 0.9f, 1e-6f);
  EXPECT_NEAR(hits.t[1], 1.1f, 1e-6f);
}

}  // namespace
}  // namespace strata::testing
