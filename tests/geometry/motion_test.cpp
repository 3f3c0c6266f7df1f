#include "worker/math/motion.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/math/elementary.h"

namespace strata::testing {
namespace {

double Distance(const Transform& a, const Transform& b, Vec3d p) {
  return Length(a.Point(p) - b.Point(p));
}

/// The map at `time` between steps, as rays see it.
Transform At(const std::vector<Transform>& steps, float time) {
  const MotionTime at(time, static_cast<int>(steps.size()) - 1);
  Transform map;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column)
      map.m[row][column] = steps[at.step].m[row][column] * (1 - double{at.fraction}) +
                           steps[at.step + 1].m[row][column] * at.fraction;
  }
  return map;
}

TEST(MotionSteps, TranslationsAndStretchesAreOneStraightPiece) {
  const Transform start = Transform::Translate(1, 2, 3) * Transform::Scale(1, 2, 3);
  const Transform end = Transform::Translate(-4, 0, 8) * Transform::Scale(2, 2, 0.5);
  const auto steps = MotionSteps(start, end);
  ASSERT_TRUE(steps.has_value());
  ASSERT_EQ(steps->size(), 2u);
  EXPECT_EQ(steps->front(), start);
  EXPECT_EQ(steps->back(), end);
}

TEST(MotionSteps, TurnsFollowTheGreatArcWithinTheirTolerance) {
  Random random(3);
  for (const double degrees : {0.5, 20.0, 57.0, 90.0, 179.0}) {
    const Vec3d axis = UnitVector(random);
    const Transform before = RandomSimilarity(random);
    const Transform turned = before * Transform::Rotate(degrees, axis.x, axis.y, axis.z);
    const auto steps = MotionSteps(before, turned);
    ASSERT_TRUE(steps.has_value());
    ASSERT_LE(static_cast<int>(steps->size()), kMaxMotionPieces + 1);
    const double piece = Radians(degrees) / static_cast<double>(steps->size() - 1);
    const double tolerance = std::max(0x1p-17, piece * piece / 8) * 1.001 + 1e-7;
    EXPECT_LE(tolerance, 8e-5);
    for (const float time : {0.0f, 0.013f, 0.3f, 0.5f, 0.77f, 1.0f}) {
      const Transform exact = before * Transform::Rotate(degrees * time, axis.x, axis.y, axis.z);
      const Vec3d p = UnitVector(random);
      EXPECT_LE(Distance(At(*steps, time), exact, p), tolerance) << degrees << " at " << time;
    }
  }
}

/// Translation, rotation and stretch each go their own way.
TEST(MotionSteps, AnyMapIsPartedIntoItsFactors) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    const double mirror = trial & 1 ? -1 : 1;
    const auto stretch = [&] {
      const Transform turn = RandomRotation(random);
      return *turn.Inverse() *
             Transform::Scale(Uniform(random, 0.5, 2), Uniform(random, 0.5, 2),
                              Uniform(random, 0.5, 2)) *
             turn * Transform::Scale(mirror, mirror, mirror);
    };
    const Transform s0 = stretch(), s1 = stretch(), turn = RandomRotation(random);
    const Vec3d axis = UnitVector(random), from = UnitVector(random), to = UnitVector(random);
    const double degrees = Uniform(random, 0, 170);
    const auto exact = [&](double t) {
      Transform between = s0;
      for (int i = 0; i < 9; ++i)
        between.m[i / 3][i % 3] = s0.m[i / 3][i % 3] * (1 - t) + s1.m[i / 3][i % 3] * t;
      const Vec3d p = Lerp(t, from, to);
      return Transform::Translate(p.x, p.y, p.z) *
             Transform::Rotate(degrees * t, axis.x, axis.y, axis.z) * turn * between;
    };
    const auto steps = MotionSteps(exact(0), exact(1));
    ASSERT_TRUE(steps.has_value());
    for (int i = 0; i < 10; ++i) {
      const float time = static_cast<float>(Uniform(random));
      EXPECT_LE(Distance(At(*steps, time), exact(time), UnitVector(random)), 3e-4) << trial;
    }
  }
}

TEST(MotionSteps, WhatCannotMoveIsTold) {
  EXPECT_FALSE(MotionSteps({}, Transform::Scale(1, 1, -1)));
  EXPECT_FALSE(MotionSteps(Transform::Scale(1, 0, 1), {}));
  Transform projective;
  projective.m[3][2] = 1;
  EXPECT_FALSE(MotionSteps({}, projective));
  EXPECT_TRUE(MotionSteps(Transform::Scale(1, 1, -1), Transform::Scale(-1, 1, 1)));
}

SceneDescription Moving(std::vector<ShapeDescription> shapes, const Transform& start,
                        const Transform& end) {
  SceneDescription scene = EmptyScene();
  scene.objects.push_back(ObjectOf(std::move(shapes)));
  scene.instances.push_back(InstanceOf(0, start));
  scene.instances.back().to_world_at_end = end;
  return scene;
}

std::vector<ShapeDescription> Parts() {
  TriangleMeshShape mesh = SphereMesh(12);
  mesh.normals = mesh.positions;
  return {Shape(mesh, Transform::Scale(0.5, 0.8, 0.6)),
          Shape(SphereShape{0.4f, -0.4f, 0.4f, 360}, Transform::Translate(1, 0.2, 0))};
}

TEST(MovingInstances, AreAtEachTimeWhereTheirStepsSay) {
  Random random(5);
  int hits = 0, differ = 0;
  for (int trial = 0; trial < 6; ++trial) {
    const Transform start = RandomSimilarity(random);
    const Transform end = Transform::Translate(0.4, -0.3, 0.2) * start * RandomRotation(random) *
                          Transform::Scale(1.2, 0.9, 1);
    const auto steps = MotionSteps(start, end);
    ASSERT_TRUE(steps.has_value());
    const auto moving = MustBuild(Moving(Parts(), start, end));
    EXPECT_TRUE(moving->moves());
    for (const float time : {0.0f, 0.26f, 0.6f, 1.0f}) {
      SceneDescription still = EmptyScene();
      for (ShapeDescription shape : Parts()) {
        shape.to_world = At(*steps, time) * shape.to_world;
        still.shapes.push_back(shape);
      }
      const auto there = MustBuild(still);
      for (int i = 0; i < 1000; ++i) {
        const Vec3d target = At(*steps, time).Point(UnitVector(random) * 0.5);
        const Vec3d from = target + UnitVector(random) * 4;
        Ray ray = MakeRay(from, Normalize(target - from));
        ray.time = time;
        Hit a, b;
        const bool found = moving->Intersect(ray, &a);
        EXPECT_EQ(found, moving->Occluded(ray));
        if (found != there->Intersect(ray, &b) || (found && std::abs(a.t - b.t) > 1e-4f)) {
          ++differ;
          continue;
        }
        if (!found) continue;
        ++hits;
        const SurfacePoint pa = moving->Surface(ray, a), pb = there->Surface(ray, b);
        EXPECT_LT(Length(pa.p - pb.p), 1e-5f);
        EXPECT_GT(Dot(pa.ng, pb.ng), 0.9999f);
        EXPECT_GT(Dot(pa.ns, pb.ns), 0.999f);
      }
    }
  }
  EXPECT_GT(hits, 12000);
  EXPECT_LE(differ, 12);
}

/// As in self_intersection_test.cpp, at random times, by single rays and by eight at once.
TEST(MovingInstances, RaysLeaveThem) {
  for (const double scale : {1e-4, 1.0, 1e3, 1e6}) {
    for (const bool curved : {false, true}) {
      SCOPED_TRACE("scale " + std::to_string(scale) + (curved ? " sphere" : " mesh"));
      Random random(curved ? 6 : 7);
      const Transform start = RandomAffine(random, scale);
      const Transform end = Transform::Translate(3 * scale, 2 * scale, -scale) * start *
                            RandomRotation(random) * Transform::Scale(1.3, 1, 0.8);
      const auto steps = MotionSteps(start, end);
      ASSERT_TRUE(steps.has_value());
      const auto geometry = MustBuild(
          Moving({Shape(curved ? ShapeGeometry(SphereShape{}) : ShapeGeometry(SphereMesh(20)))},
                 start, end));
      int hits = 0, again = 0, escaped = 0;
      for (int packet = 0; packet < 4000; ++packet) {
        RayLanes out, in;
        MaskLanes mask = {};
        for (int lane = 0; lane < kLanes; ++lane) {
          const float time = static_cast<float>(Uniform(random));
          const Transform there = At(*steps, time);
          const Vec3d from = there.Point(UnitVector(random) * Uniform(random, 2, 4));
          const Vec3d target = there.Point(UnitVector(random) * Uniform(random, 0, 0.9));
          Ray ray = MakeRay(from, Normalize(target - from));
          ray.time = time;
          Hit hit;
          if (!geometry->Intersect(ray, &hit)) continue;
          ++hits;
          const SurfacePoint point = geometry->Surface(ray, hit);
          Vec3f w = ToFloat(UnitVector(random));
          if (Dot(w, point.ng) < 0) w = -w;
          out.origin.Set(lane, OffsetRayOrigin(point, w));
          in.origin.Set(lane, OffsetRayOrigin(point, -w));
          out.direction.Set(lane, w);
          in.direction.Set(lane, -w);
          out.time[lane] = in.time[lane] = time;
          mask[lane] = -1;
          again += geometry->Occluded(out.Get(lane));
          escaped += !geometry->Occluded(in.Get(lane));
        }
        again += __builtin_popcount(Bits(Occluded(*geometry, out, mask)));
        escaped += __builtin_popcount(Bits(mask & ~Occluded(*geometry, in, mask)));
      }
      EXPECT_GT(hits, 25000);
      EXPECT_LE(again, 1);
      EXPECT_LE(escaped, 4);
    }
  }
}

TEST(MovingInstances, BoundsHoldTheWholeWay) {
  const auto geometry = MustBuild(Moving({Shape(CubeMesh(), Transform::Translate(3, 0, 0))}, {},
                                         Transform::Rotate(90, 0, 0, 1)));
  EXPECT_NEAR(geometry->bounds().max.x, 4.13, 0.15);  // The far corners pass (4.12, 0).
  EXPECT_GE(geometry->bounds().max.y, 4);
}

TEST(MovingInstances, WhatCannotBeIsALocatedError) {
  const auto message = [](const SceneDescription& scene) {
    return std::string(Geometry::Build(scene).status().message());
  };
  EXPECT_EQ(message(Moving({Shape(CubeMesh())}, {}, Transform::Scale(1, 1, -1)))
                .rfind("scene.pbrt:12: ", 0),
            0u);
  ShapeDescription lamp = Shape(SphereShape{});
  lamp.emission = AreaEmission{Rgb::Gray(3)};
  EXPECT_EQ(message(Moving({lamp}, {}, Transform::Translate(1, 0, 0))),
            "scene.pbrt:7: a shape that emits cannot move");
}

}  // namespace
}  // namespace strata::testing
