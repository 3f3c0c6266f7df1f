#include <array>
#include <cmath>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"
#include "worker/geometry/geometry_lanes.h"

namespace strata::testing {
namespace {

/// One segment whose radius goes from `r0` to `r1`.
CurveShape Segment(CurveKind kind, std::array<Vec3d, 4> p, double r0, double r1) {
  CurveShape curve;
  curve.kind = kind;
  for (int i = 0; i < 4; ++i) {
    curve.positions.push_back(ToFloat(p[i]));
    curve.radii.push_back(static_cast<float>(r0 + (r1 - r0) * i / 3));
  }
  curve.segments = {0};
  return curve;
}

std::array<Vec3d, 4> Straight(Vec3d a, Vec3d b) {
  return {a, Lerp(1.0 / 3, a, b), Lerp(2.0 / 3, a, b), b};
}

/// A quarter of a circle of radius 1 around the origin, within 3e-4.
std::array<Vec3d, 4> Quarter() {
  constexpr double kArm = 0.5522847498;
  return {Vec3d{1, 0, 0}, {1, kArm, 0}, {kArm, 1, 0}, {0, 1, 0}};
}

std::optional<SurfacePoint> Meet(const Geometry& geometry, const Ray& ray) {
  Hit hit;
  const bool found = geometry.Intersect(ray, &hit);
  EXPECT_EQ(found, geometry.Occluded(ray));
  if (!found) return std::nullopt;
  return geometry.Surface(ray, hit);
}

TEST(Curves, AStraightTubeIsACylinder) {
  Random random(1);
  const Transform to_world = RandomSimilarity(random);
  const auto tube = MustBuild(
      Shape(Segment(CurveKind::kCylinder, Straight({0, 0, -1}, {0, 0, 1}), 0.1, 0.1), to_world));
  const auto cylinder = MustBuild(Shape(CylinderShape{0.1f, -1, 1, 360}, to_world));
  int hits = 0, differ = 0;
  for (int i = 0; i < 20000; ++i) {
    // Not through the open ends.
    const Vec3d target = {Uniform(random, -0.15, 0.15), Uniform(random, -0.15, 0.15),
                          Uniform(random, -0.7, 0.7)};
    const double phi = Uniform(random, 0, 2 * M_PI);
    const Vec3d from = target + Vec3d{2 * std::cos(phi), 2 * std::sin(phi), Uniform(random, -1, 1)};
    const Ray ray =
        MakeRay(to_world.Point(from), Normalize(to_world.Point(target) - to_world.Point(from)));
    const auto a = Meet(*tube, ray), b = Meet(*cylinder, ray);
    if (a.has_value() != b.has_value()) {
      ++differ;
      continue;
    }
    if (!a) continue;
    ++hits;
    EXPECT_LT(Length(a->p - b->p), 3e-5f);
    // At the silhouette a hit's place, and so its normal, is at its least certain.
    EXPECT_GT(Dot(a->ng, b->ng), AbsDot(ray.direction, b->ng) > 0.1f ? 0.99999f : 0.99f);
    EXPECT_LT(AbsDot(Normalize(a->dpdu), a->ng), 1e-5f);
    EXPECT_NEAR(a->uv.y, 0.5, 0.5);
  }
  EXPECT_GT(hits, 8000);
  EXPECT_LE(differ, 20);
}

TEST(Curves, ATaperedTubeIsACone) {
  const auto cone =
      MustBuild(Shape(Segment(CurveKind::kCylinder, Straight({0, 0, 0}, {0, 0, 2}), 0.4, 0.1)));
  for (double z = 0.2; z < 1.9; z += 0.2) {
    const Ray ray = MakeRay({5, 0, z}, {-1, 0, 0});
    const auto point = Meet(*cone, ray);
    ASSERT_TRUE(point.has_value());
    EXPECT_NEAR(point->p.x, 0.4 - 0.15 * z, 1e-5);
    EXPECT_NEAR(point->p.z, z, 1e-5);
    const Vec3d normal = Normalize(Vec3d{1, 0, 0.15});
    EXPECT_GT(Dot(ToDouble(point->ng), normal), 1 - 1e-6);
    EXPECT_NEAR(point->uv.x, z / 2, 1e-5);
    EXPECT_NEAR(point->uv.y, 0.5, 1e-4);
  }
}

TEST(Curves, ABentTubeIsATorus) {
  Random random(2);
  const auto torus = MustBuild(Shape(Segment(CurveKind::kCylinder, Quarter(), 0.1, 0.1)));
  int hits = 0;
  for (int i = 0; i < 5000; ++i) {
    const double phi = Uniform(random, 0.1, M_PI / 2 - 0.1);
    const Vec3d target = {std::cos(phi), std::sin(phi), 0};
    const Vec3d from = target + UnitVector(random) * 0.5;
    const Ray ray = MakeRay(from, Normalize(target - from));
    if (std::hypot(std::hypot(from.x, from.y) - 1, from.z) < 0.12) continue;
    const auto point = Meet(*torus, ray);
    ASSERT_TRUE(point.has_value());
    ++hits;
    const Vec3d p = ToDouble(point->p);
    const double around = std::hypot(p.x, p.y);
    EXPECT_NEAR(std::hypot(around - 1, p.z), 0.1, 1e-3);
    const Vec3d axis = {p.x / around, p.y / around, 0};
    EXPECT_GT(Dot(ToDouble(point->ng), Normalize(p - axis)), 0.999);
  }
  EXPECT_GT(hits, 4000);
}

TEST(Curves, FlatOnesFaceEveryRayAndAreAsWideAsTheySay) {
  Random random(3);
  const auto flat =
      MustBuild(Shape(Segment(CurveKind::kFlat, Straight({0, 0, -1}, {0, 0, 1}), 0.2, 0.1)));
  for (int i = 0; i < 5000; ++i) {
    const double z = Uniform(random, -0.95, 0.95), phi = Uniform(random, 0, 2 * M_PI);
    const Vec3d toward = {-std::cos(phi), -std::sin(phi), 0};
    const double radius = 0.15 - 0.05 * z, off = Uniform(random, -1.5, 1.5) * radius;
    if (std::abs(std::abs(off) - radius) < 1e-4) continue;
    const Vec3d across = Cross(toward, {0, 0, 1});
    const Vec3d target = Vec3d{0, 0, z} + across * off;
    const auto point = Meet(*flat, MakeRay(target - toward * 3, toward));
    ASSERT_EQ(point.has_value(), std::abs(off) < radius) << off << " " << radius;
    if (!point) continue;
    EXPECT_LT(Length(point->p - ToFloat(target)), 1e-5f);
    EXPECT_GT(Dot(ToDouble(point->ng), -toward), 1 - 1e-5);
    EXPECT_NEAR(point->uv.x, (z + 1) / 2, 1e-3);
    EXPECT_NEAR(point->uv.y, 0.5 + 0.5 * off / radius, 1e-3);
  }
}

CurveShape Ribbon(Vec3f normal0, Vec3f normal1) {
  CurveShape ribbon = Segment(CurveKind::kRibbon, Straight({0, 0, -1}, {0, 0, 1}), 0.2, 0.2);
  for (int i = 0; i < 4; ++i)
    ribbon.normals.push_back(Normalize(normal0 * (1 - i / 3.0f) + normal1 * (i / 3.0f)));
  return ribbon;
}

TEST(Curves, RibbonsLieAcrossTheirNormals) {
  Random random(4);
  const auto ribbon = MustBuild(Shape(Ribbon({0, 1, 0}, {0, 1, 0})));
  for (int i = 0; i < 5000; ++i) {
    const Vec3d target = {Uniform(random, -0.3, 0.3), 0, Uniform(random, -0.95, 0.95)};
    if (std::abs(std::abs(target.x) - 0.2) < 1e-4) continue;
    Vec3d toward = UnitVector(random);
    if (std::abs(toward.y) < 0.05) continue;
    const auto point = Meet(*ribbon, MakeRay(target - toward * 3, toward));
    ASSERT_EQ(point.has_value(), std::abs(target.x) < 0.2);
    if (!point) continue;
    EXPECT_LT(Length(point->p - ToFloat(target)), 2e-5f);
    EXPECT_GT(point->ng.y, 1 - 1e-5f);
    EXPECT_NEAR(point->uv.x, (target.z + 1) / 2, 1e-3);
    EXPECT_NEAR(point->uv.y, 0.5 + target.x / 0.4, 1e-3);
  }
  // A quarter turn: the middle looks half way.
  const auto twisted = MustBuild(Shape(Ribbon({0, 1, 0}, {1, 0, 0})));
  const auto point = Meet(*twisted, MakeRay({3, 3, 0}, Normalize(Vec3d{-1, -1, 0})));
  ASSERT_TRUE(point.has_value());
  EXPECT_GT(Dot(point->ng, Normalize(Vec3f{1, 1, 0})), 0.99f);
}

TEST(Curves, InstancesEqualCopies) {
  Random random(5);
  for (const CurveKind kind : {CurveKind::kFlat, CurveKind::kCylinder, CurveKind::kRibbon}) {
    CurveShape curve = Segment(kind, Quarter(), 0.05, 0.02);
    if (kind == CurveKind::kRibbon) curve.normals.assign(4, {0, 0, 1});
    SceneDescription instanced = EmptyScene(), copied = EmptyScene();
    instanced.objects.push_back(ObjectOf({Shape(curve)}));
    for (int i = 0; i < 3; ++i) {
      const Transform to_world = RandomSimilarity(random, 0.3);
      instanced.instances.push_back(InstanceOf(0, to_world));
      copied.shapes.push_back(Shape(curve, to_world));
    }
    const auto a = MustBuild(instanced), b = MustBuild(copied);
    int hits = 0, differ = 0;
    for (int i = 0; i < 20000; ++i) {
      const double phi = Uniform(random, 0, M_PI / 2);
      const Vec3d target = instanced.instances[i % 3].to_world.Point(
          Vec3d{std::cos(phi), std::sin(phi), 0} + UnitVector(random) * 0.03);
      const Vec3d from = target + UnitVector(random);
      const Ray ray = MakeRay(from, Normalize(target - from));
      const auto pa = Meet(*a, ray), pb = Meet(*b, ray);
      if (pa.has_value() != pb.has_value() ||
          (pa && (Length(pa->p - pb->p) > 1e-4f || Dot(pa->ng, pb->ng) < 0.99f))) {
        ++differ;
        continue;
      }
      hits += pa.has_value();
    }
    EXPECT_GT(hits, 5000);
    EXPECT_LE(differ, 60) << static_cast<int>(kind);
  }
}

/// How many rays that leave a flat curve meet it anew, at most: it turns to face them. Let a ray
/// leave a straight one of radius r at the distance o from its axis, at an angle theta to the axis,
/// and psi the angle, about the axis, between its way and that back to the axis. It comes nearest
/// to the axis after o cos(psi) / sin(theta). That is a hit beyond 2 r, below which Embree takes
/// none, so if sin(theta) < a = o cos(psi) / (2 r), and cos(psi) > 0, as for half of them. Of
/// directions even in solid angle the part 1 - sqrt(1 - a^2) <= a^2 / (1 + sqrt(3/4)) has that, as
/// a <= 1/2. Here o = r |x sin(phi)| with x even in [-1, 1] and phi, the angle of the ray that
/// came, even, as is psi: the mean of a^2 is 1/3 1/2 1/2 / 4.
const double kMeetAnew = 0.5 * (1.0 / 48) / (1 + std::sqrt(0.75));
/// Normal, two-sided at p = 1e-5.
constexpr double kCritical = 4.417;

/// Rays that leave a curve on the outside meet nothing: in the middle of a long straight one, and
/// in single rays and packets alike.
TEST(Curves, RaysLeaveThem) {
  for (const CurveKind kind : {CurveKind::kFlat, CurveKind::kCylinder, CurveKind::kRibbon}) {
    for (const double scale : {1e-3, 1.0, 1e3}) {
      for (const double thin : {0.1, 1e-3}) {
        SCOPED_TRACE("kind " + std::to_string(static_cast<int>(kind)) + " scale " +
                     std::to_string(scale) + " radius " + std::to_string(thin));
        Random random(6);
        const Transform to_world = RandomSimilarity(random, scale);
        CurveShape curve = Segment(kind, Straight({0, 0, -1}, {0, 0, 1}), thin, thin);
        if (kind == CurveKind::kRibbon) curve.normals.assign(4, {0, 1, 0});
        const auto geometry = MustBuild(Shape(curve, to_world));
        int hits = 0, again = 0;
        RayLanes packet;
        MaskLanes mask = {};
        for (int i = 0; i < 8000; ++i) {
          const Vec3d target = {Uniform(random, -thin, thin), 0, Uniform(random, -0.9, 0.9)};
          const Vec3d from = target + UnitVector(random) * 2;
          const Ray ray = MakeRay(to_world.Point(from),
                                  Normalize(to_world.Point(target) - to_world.Point(from)));
          Hit hit;
          if (!geometry->Intersect(ray, &hit)) continue;
          const SurfacePoint point = geometry->Surface(ray, hit);
          if (kind == CurveKind::kCylinder && Dot(point.ng, ray.direction) > 0) continue;
          ++hits;
          Vec3f out = ToFloat(UnitVector(random));
          if (Dot(out, point.ng) < 0) out = -out;
          const Ray leaving = {OffsetRayOrigin(point, out), out};
          again += geometry->Occluded(leaving);
          const int lane = i % kLanes;
          packet.origin.Set(lane, leaving.origin);
          packet.direction.Set(lane, leaving.direction);
          mask[lane] = -1;
          if (lane != kLanes - 1) continue;
          again += __builtin_popcount(Bits(Occluded(*geometry, packet, mask)));
          mask = MaskLanes{};
        }
        EXPECT_GT(hits, 3000);
        // Each ray is traced twice.
        const double likely = kind == CurveKind::kFlat ? hits * kMeetAnew : 0;
        double most = 2 * (likely + kCritical * std::sqrt(likely));
        // No closed form bounds what Embree's iteration for tubes errs by near silhouettes. What is
        // asked is that the light it costs cannot be seen: a quarter of a step of 8 bits.
        if (kind == CurveKind::kCylinder) most = hits / 1024.0;
        EXPECT_LE(again, most);
      }
    }
  }
}

TEST(Curves, WhatHasNoWidthIsNotThereAndMistakesAreLocated) {
  SceneDescription scene = EmptyScene();
  scene.shapes.push_back(Shape(Segment(CurveKind::kFlat, Straight({0, 0, -1}, {0, 0, 1}), 0, 0)));
  EXPECT_FALSE(MustBuild(scene)->Occluded({{0, 5, 0}, {0, -1, 0}}));
  CurveShape broken = Segment(CurveKind::kFlat, Straight({0, 0, -1}, {0, 0, 1}), 1, 1);
  broken.segments = {1};
  scene.shapes = {Shape(broken)};
  EXPECT_EQ(Geometry::Build(scene).status().message(),
            "scene.pbrt:7: a segment of the curve has no four control points");
}

}  // namespace
}  // namespace strata::testing
