#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"
#include "worker/geometry/curved_shape.h"

// Each shape against an intersection worked out otherwise: the ray is taken into the shape's space
// in long double and the textbook equation solved there.

namespace strata::testing {
namespace {

struct LocalRay {
  long double o[3], d[3];
  std::array<double, 3> At(long double t) const {
    return {static_cast<double>(o[0] + t * d[0]), static_cast<double>(o[1] + t * d[1]),
            static_cast<double>(o[2] + t * d[2])};
  }
};

LocalRay ToLocal(const Ray& ray, const Transform& to_world) {
  const Transform inverse = *to_world.Inverse();
  const Vec3d o = inverse.Point(ToDouble(ray.origin));
  const Vec3d d = inverse.Vector(ToDouble(ray.direction));
  return {{o.x, o.y, o.z}, {d.x, d.y, d.z}};
}

std::vector<double> QuadraticRoots(long double a, long double b, long double c) {
  const long double discriminant = b * b - 4 * a * c;
  if (discriminant < 0 || a == 0) return {};
  const long double root = std::sqrt(discriminant);
  return {static_cast<double>((-b - root) / (2 * a)), static_cast<double>((-b + root) / (2 * a))};
}

double AngleOf(double x, double y) {
  const double phi = std::atan2(y, x) * 180 / M_PI;
  return phi < 0 ? phi + 360 : phi;
}

/// All distances at which the ray meets the shape, by the textbook.
std::vector<double> Meetings(const SphereShape& s, const LocalRay& r) {
  std::vector<double> result;
  long double a = 0, b = 0, c = -static_cast<long double>(s.radius) * s.radius;
  for (int i = 0; i < 3; ++i) {
    a += r.d[i] * r.d[i];
    b += 2 * r.o[i] * r.d[i];
    c += r.o[i] * r.o[i];
  }
  for (const double t : QuadraticRoots(a, b, c)) {
    const auto [x, y, z] = r.At(t);
    const bool cut = (s.z_min > -s.radius && z < s.z_min) || (s.z_max < s.radius && z > s.z_max);
    if (!cut && AngleOf(x, y) <= s.phi_max) result.push_back(t);
  }
  return result;
}

std::vector<double> Meetings(const CylinderShape& s, const LocalRay& r) {
  std::vector<double> result;
  const long double a = r.d[0] * r.d[0] + r.d[1] * r.d[1];
  const long double b = 2 * (r.o[0] * r.d[0] + r.o[1] * r.d[1]);
  const long double c =
      r.o[0] * r.o[0] + r.o[1] * r.o[1] - static_cast<long double>(s.radius) * s.radius;
  for (const double t : QuadraticRoots(a, b, c)) {
    const auto [x, y, z] = r.At(t);
    const auto [low, high] = std::minmax(s.z_min, s.z_max);
    if (z >= low && z <= high && AngleOf(x, y) <= s.phi_max) result.push_back(t);
  }
  return result;
}

std::vector<double> Meetings(const DiskShape& s, const LocalRay& r) {
  const double t = static_cast<double>((s.height - r.o[2]) / r.d[2]);
  const auto [x, y, z] = r.At(t);
  const double radius = std::hypot(x, y);
  if (radius <= s.radius && radius >= s.inner_radius && AngleOf(x, y) <= s.phi_max) return {t};
  return {};
}

template <typename ShapeKind>
void CompareWithTextbook(const ShapeKind& shape, uint64_t seed, double scale, double min_share) {
  Random random(seed);
  const Transform to_world = RandomAffine(random, scale);
  const auto geometry = MustBuild(Shape(shape, to_world));
  int hits = 0, differ = 0;
  constexpr int kRays = 10000;
  for (int i = 0; i < kRays; ++i) {
    const Vec3d from = to_world.Point(UnitVector(random) * Uniform(random, 0, 4));
    const Vec3d target = to_world.Point(UnitVector(random) * Uniform(random, 0, 1));
    const Ray ray = MakeRay(from, Normalize(target - from));
    std::optional<double> expected;
    for (const double t : Meetings(shape, ToLocal(ray, to_world))) {
      if (t > 0 && (!expected || t < *expected)) expected = t;
    }
    Hit hit;
    const bool found = geometry->Intersect(ray, &hit);
    EXPECT_EQ(found, geometry->Occluded(ray));
    if (found != expected.has_value()) {
      ++differ;
      continue;
    }
    if (!found) continue;
    ++hits;
    if (std::abs(hit.t - *expected) > 1e-6 * (*expected + scale)) {
      ++differ;
      continue;
    }
    const SurfacePoint point = geometry->Surface(ray, hit);
    const Vec3d along = ToDouble(ray.origin) + ToDouble(ray.direction) * *expected;
    EXPECT_LT(Length(ToDouble(point.p) - along), 2e-6 * (scale * 8 + *expected));
    EXPECT_NEAR(Length(point.ng), 1, 1e-6);
    EXPECT_LT(std::abs(Dot(point.ng, point.dpdu)), 1e-5f * (Length(point.dpdu) + 1e-6f));
    EXPECT_GE(point.uv.x, 0);
    EXPECT_LE(point.uv.x, 1);
    EXPECT_GE(point.uv.y, 0);
    EXPECT_LE(point.uv.y, 1);
    // Segments that end just before or behind the hit.
    EXPECT_FALSE(geometry->Occluded({ray.origin, ray.direction, hit.t * 0.9999f}));
    EXPECT_TRUE(geometry->Occluded({ray.origin, ray.direction, hit.t * 1.0001f}));
  }
  EXPECT_GT(hits, kRays * min_share);
  // Rays through the very border of a shape may fall on either side of it.
  EXPECT_LE(differ, 2) << "seed " << seed << " scale " << scale;
}

TEST(Shapes, SpheresAreWhereTheyShouldBe) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    for (const double scale : {1e-4, 1.0, 1e5}) {
      CompareWithTextbook(SphereShape{}, seed, scale, 0.8);
      CompareWithTextbook(SphereShape{0.9f, -0.3f, 0.7f, 250}, seed, scale, 0.3);
      CompareWithTextbook(SphereShape{0.9f, -0.9f, 0.2f, 100}, seed, scale, 0.05);
    }
  }
}

TEST(Shapes, DisksAreWhereTheyShouldBe) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    for (const double scale : {1e-4, 1.0, 1e5}) {
      CompareWithTextbook(DiskShape{0.1f, 1.5f, 0, 360}, seed, scale, 0.2);
      CompareWithTextbook(DiskShape{-0.2f, 1.2f, 0.4f, 180}, seed, scale, 0.05);
      CompareWithTextbook(DiskShape{0, 1.2f, 0.1f, 300}, seed, scale, 0.1);
    }
  }
}

TEST(Shapes, CylindersAreWhereTheyShouldBe) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    for (const double scale : {1e-4, 1.0, 1e5}) {
      CompareWithTextbook(CylinderShape{0.8f, -1, 1, 360}, seed, scale, 0.4);
      CompareWithTextbook(CylinderShape{0.8f, 0.7f, -0.2f, 200}, seed, scale, 0.05);
      CompareWithTextbook(CylinderShape{0.8f, -0.5f, 0.6f, 90}, seed, scale, 0.05);
    }
  }
}

TEST(Shapes, PatchesHaveAreaUnlessTheyAreLines) {
  const auto has_area = [](const std::array<Vec3d, 4>& corners) {
    BilinearPatchSurface patch;
    std::copy(corners.begin(), corners.end(), patch.p);
    CurvedShape shape;
    shape.surface = patch;
    EXPECT_EQ(HasArea(shape), AreaOf(shape) > 0);
    return HasArea(shape);
  };
  EXPECT_TRUE(has_area({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 1}}}));
  EXPECT_TRUE(has_area({{{0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 1, 0}}})) << "a triangle";
  EXPECT_FALSE(has_area({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}}}));
  EXPECT_FALSE(has_area({{{0, 0, 0}, {0, 0, 0}, {1, 2, 3}, {1, 2, 3}}}));
  EXPECT_FALSE(has_area({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1}}}));
  CurvedShape sphere;
  sphere.surface = SphereSurface(SphereShape{0.5f});
  EXPECT_TRUE(HasArea(sphere));
}

TEST(Shapes, PatchesAreWhereTheirCornersPutThem) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    BilinearPatchShape patch;
    for (int i = 0; i < 4; ++i) {
      patch.positions.push_back(
          {(i & 1 ? 1.0f : -1.0f) + static_cast<float>(Uniform(random, -.3, .3)),
           (i & 2 ? 1.0f : -1.0f) + static_cast<float>(Uniform(random, -.3, .3)),
           static_cast<float>(Uniform(random, -0.6, 0.6))});
    }
    if (seed == 0) {  // A parallelogram, whose quadratic is linear.
      patch.positions = {{-1, -1, 0}, {1, -1, 0.5f}, {-1, 1, 0.25f}, {1, 1, 0.75f}};
    }
    patch.patches = {{0, 1, 2, 3}};
    const Transform to_world = RandomAffine(random);
    const auto geometry = MustBuild(Shape(patch, to_world));
    const auto at = [&](double u, double v) {
      Vec3d corner[4];
      for (int i = 0; i < 4; ++i) corner[i] = to_world.Point(ToDouble(patch.positions[i]));
      return Lerp(v, Lerp(u, corner[0], corner[1]), Lerp(u, corner[2], corner[3]));
    };
    for (int i = 0; i < 2000; ++i) {
      // A ray at a chosen point of the patch comes back with its parameters, or with a nearer hit.
      const double u = Uniform(random), v = Uniform(random);
      const Vec3d target = at(u, v);
      const Vec3d from = to_world.Point(UnitVector(random) * 4);
      const Ray ray = MakeRay(from, Normalize(target - from));
      Hit hit;
      const double distance = Length(target - from);
      const double margin = std::min({u, v, 1 - u, 1 - v});
      // Where the ray only touches the patch, rounding decides whether it does.
      const Vec3d normal = Normalize(Cross(at(1, v) - at(0, v), at(u, 1) - at(u, 0)));
      if (std::abs(Dot(normal, ToDouble(ray.direction))) < 0.02) continue;
      if (!geometry->Intersect(ray, &hit)) {
        EXPECT_LT(margin, 1e-3) << "a ray at (" << u << ", " << v << ") missed";
        continue;
      }
      const SurfacePoint point = geometry->Surface(ray, hit);
      if (hit.t > distance * 0.999) {
        EXPECT_LT(Length(ToDouble(point.p) - target), 1e-3);
        // The claimed parameters lead to the claimed point.
        EXPECT_LT(Length(ToDouble(point.p) - at(point.uv.x, point.uv.y)), 1e-5);
      } else {
        EXPECT_LT(Length(ToDouble(point.p) - at(point.uv.x, point.uv.y)), 1e-5);
      }
    }
  }
}

/// Brute force over all triangles in double (Cramer's rule).
std::optional<double> NearestTriangle(const TriangleMeshShape& mesh, const Transform& to_world,
                                      const Ray& ray) {
  std::optional<double> nearest;
  const Vec3d o = ToDouble(ray.origin), d = ToDouble(ray.direction);
  for (const auto& triangle : mesh.triangles) {
    const Vec3d p0 = to_world.Point(ToDouble(mesh.positions[triangle[0]]));
    const Vec3d e1 = to_world.Point(ToDouble(mesh.positions[triangle[1]])) - p0;
    const Vec3d e2 = to_world.Point(ToDouble(mesh.positions[triangle[2]])) - p0;
    const Vec3d cross = Cross(d, e2);
    const double determinant = Dot(e1, cross);
    if (determinant == 0) continue;
    const double u = Dot(o - p0, cross) / determinant;
    const Vec3d q = Cross(o - p0, e1);
    const double v = Dot(d, q) / determinant, t = Dot(e2, q) / determinant;
    if (u < 0 || v < 0 || u + v > 1 || t <= 0) continue;
    if (!nearest || t < *nearest) nearest = t;
  }
  return nearest;
}

TEST(Shapes, MeshesAreWhereTheirTrianglesAre) {
  for (const double scale : {1e-4, 1.0, 1e5}) {
    Random random(3);
    const Transform to_world = RandomAffine(random, scale);
    TriangleMeshShape mesh;
    for (int i = 0; i < 300; ++i)
      mesh.positions.push_back(ToFloat(UnitVector(random) * Uniform(random)));
    for (uint32_t i = 0; i + 2 < 300; i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
    const auto geometry = MustBuild(Shape(mesh, to_world));
    int differ = 0, hits = 0;
    for (int i = 0; i < 10000; ++i) {
      const Vec3d from = to_world.Point(UnitVector(random) * Uniform(random, 0, 3));
      const Vec3d target = to_world.Point(UnitVector(random) * Uniform(random, 0, 1));
      const Ray ray = MakeRay(from, Normalize(target - from));
      const std::optional<double> expected = NearestTriangle(mesh, to_world, ray);
      Hit hit;
      const bool found = geometry->Intersect(ray, &hit);
      if (found != expected.has_value() ||
          (found && std::abs(hit.t - *expected) > 1e-4 * (*expected + scale))) {
        ++differ;
        continue;
      }
      if (!found) continue;
      ++hits;
      const SurfacePoint point = geometry->Surface(ray, hit);
      const Vec3d along = ToDouble(ray.origin) + ToDouble(ray.direction) * *expected;
      EXPECT_LT(Length(ToDouble(point.p) - along), 1e-4 * scale);
    }
    EXPECT_GT(hits, 3000);
    EXPECT_LE(differ, 3) << "scale " << scale;  // Rays through an edge.
  }
}

TEST(Shapes, PointErrorsBoundTheDistanceToTheSurface) {
  // The point is given as float; how far off the sphere of the transform it is, is known exactly.
  for (const double scale : {1e-3, 1.0, 1e4}) {
    Random random(9);
    const Transform to_world = RandomSimilarity(random, scale);
    const auto geometry = MustBuild(Shape(SphereShape{}, to_world));
    const Vec3d center = to_world.Point({});
    for (int i = 0; i < 5000; ++i) {
      const Vec3d from = to_world.Point(UnitVector(random) * 3);
      const Vec3d target = to_world.Point(UnitVector(random) * 0.9);
      const Ray ray = MakeRay(from, Normalize(target - from));
      Hit hit;
      if (!geometry->Intersect(ray, &hit)) continue;
      const SurfacePoint point = geometry->Surface(ray, hit);
      const double off = std::abs(Length(ToDouble(point.p) - center) - scale);
      EXPECT_LE(off, Dot(Abs(point.ng), point.p_error) * 1.0001);
      EXPECT_LT(Length(point.p_error), 1e-5 * scale);
    }
  }
}

TEST(Shapes, ClosedMeshesHoldRandomRays) {
  const auto geometry = MustBuild(Shape(SphereMesh(30)));
  Random random(21);
  int missed = 0, not_occluded = 0;
  for (int i = 0; i < 1000000; ++i) {
    const Ray ray = MakeRay(UnitVector(random) * Uniform(random, 0, 0.9), UnitVector(random));
    Hit hit;
    missed += !geometry->Intersect(ray, &hit);
    not_occluded += !geometry->Occluded(ray);
  }
  // One in ten million slips between two triangles; three in a million would be news.
  EXPECT_LE(missed, 2);
  EXPECT_LE(not_occluded, 2);
}

}  // namespace
}  // namespace strata::testing
