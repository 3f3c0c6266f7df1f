#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"

namespace strata::testing {
namespace {

std::unique_ptr<Geometry> MustBuildEmitter(ShapeGeometry geometry, const Transform& to_world = {}) {
  ShapeDescription shape = Shape(std::move(geometry), to_world);
  shape.emission = AreaEmission{Rgb{1, 2, 3}, true};
  return MustBuild(std::move(shape));
}

BilinearPatchShape Patch(std::vector<Vec3f> corners) {
  BilinearPatchShape patch;
  patch.positions = std::move(corners);
  patch.patches = {{0, 1, 2, 3}};
  return patch;
}

const BilinearPatchShape kTwisted =
    Patch({{-1, -1, 0.3f}, {1.2f, -0.8f, -0.5f}, {-0.5f, 1, -0.2f}, {0.7f, 0.6f, 0.9f}});

TEST(Emitters, EachTriangleIsOneAndHitsNameIt) {
  ShapeDescription shape = Shape(CubeMesh(), Transform::Scale(1, 2, -1));
  shape.emission = AreaEmission{Rgb{1, 2, 3}};
  shape.reverse_orientation = true;
  const auto geometry = MustBuild(shape);
  ASSERT_EQ(geometry->emitters().size(), 12u);
  double area = 0;
  for (const Emitter& emitter : geometry->emitters()) area += emitter.area;
  EXPECT_NEAR(area, 2 * 4 + 4 * 8, 1e-5);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Ray ray = MakeRay({}, UnitVector(random));
    Hit hit;
    ASSERT_TRUE(geometry->Intersect(ray, &hit));
    const SurfacePoint point = geometry->Surface(ray, hit);
    ASSERT_GE(point.light, 0);
    const Emitter& emitter = geometry->emitters()[point.light];
    const auto& triangle = std::get<TriangleEmitter>(emitter.shape);
    EXPECT_EQ(triangle.ng, point.ng);
    EXPECT_LT(Dot(point.ng, point.p), 0) << "reversed: towards the inside";
    EXPECT_LT(std::abs(Dot(point.ng, point.p - triangle.p0)), 1e-5);
    EXPECT_EQ(emitter.radiance, (Rgb{1, 2, 3}));
    EXPECT_FALSE(emitter.two_sided);
  }
}

TEST(Emitters, WithoutAreaOrRadianceAreDropped) {
  TriangleMeshShape mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}, {1, 1, 1}};
  EXPECT_EQ(MustBuildEmitter(mesh)->emitters().size(), 1u);
  EXPECT_TRUE(MustBuildEmitter(SphereShape{1, -1, 1, 0})->emitters().empty());
  EXPECT_TRUE(MustBuildEmitter(DiskShape{0, 1, 1, 360})->emitters().empty());
  ShapeDescription dark = Shape(SphereShape{});
  dark.emission = AreaEmission{};
  EXPECT_TRUE(MustBuild(dark)->emitters().empty());
}

TEST(Emitters, FullSpheresUnderSimilaritiesAreSpheres) {
  Random random(2);
  for (const bool reversed : {false, true}) {
    ShapeDescription shape =
        Shape(SphereShape{0.5f, -0.5f, 0.5f, 360}, RandomSimilarity(random, 4));
    shape.emission = AreaEmission{Rgb::Gray(1)};
    shape.reverse_orientation = reversed;
    const auto geometry = MustBuild(shape);
    ASSERT_EQ(geometry->emitters().size(), 1u);
    const auto& sphere = std::get<SphereEmitter>(geometry->emitters()[0].shape);
    EXPECT_NEAR(sphere.radius, 2, 1e-6);
    EXPECT_EQ(sphere.inward, reversed);
    EXPECT_NEAR(geometry->emitters()[0].area, 4 * M_PI * 4, 1e-3);
    EXPECT_LT(Length(sphere.center - ToFloat(shape.to_world.Point({}))), 1e-5);
  }
  EXPECT_TRUE(std::holds_alternative<OtherEmitter>(
      MustBuildEmitter(SphereShape{}, Transform::Scale(1, 1, 1.1))->emitters()[0].shape));
  EXPECT_TRUE(std::holds_alternative<OtherEmitter>(
      MustBuildEmitter(SphereShape{1, -1, 1, 300})->emitters()[0].shape));
}

TEST(Emitters, AreasInClosedForm) {
  const auto area = [](ShapeGeometry shape, const Transform& to_world = {}) {
    return MustBuildEmitter(std::move(shape), to_world)->emitters()[0].area;
  };
  const double tolerance = 1e-5;
  EXPECT_NEAR(area(SphereShape{2, -1, 1.5f, 90}) / (M_PI / 2 * 2 * 2.5), 1, tolerance);
  EXPECT_NEAR(area(DiskShape{3, 2, 1, 120}) / (M_PI / 3 * 3), 1, tolerance);
  EXPECT_NEAR(area(DiskShape{3, 2, 0, 360}, Transform::Scale(2, 3, 9)) / (4 * M_PI * 6), 1,
              tolerance);
  EXPECT_NEAR(area(CylinderShape{2, -1, 2, 180}) / (M_PI * 2 * 3), 1, tolerance);
  EXPECT_NEAR(area(Patch({{0, 0, 0}, {2, 0, 0}, {0, 3, 0}, {2, 3, 0}})), 6, 1e-4);
  // An oblate spheroid with axes 2, 2, 1: 2 pi a^2 (1 + (1 - e^2)/e atanh(e)), e^2 = 3/4.
  const double e = std::sqrt(0.75);
  const double spheroid = 2 * M_PI * 4 * (1 + (1 - e * e) / e * std::atanh(e));
  EXPECT_NEAR(area(SphereShape{2, -2, 2, 360}, Transform::Scale(1, 1, 0.5)) / spheroid, 1, 1e-3);
  // The elliptic cylinder with axes 3 and 1, one high.
  const double perimeter = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
      [](double t) { return std::hypot(3 * std::sin(t), std::cos(t)); }, 0.0, 2 * M_PI);
  EXPECT_NEAR(area(CylinderShape{1, 0, 1, 360}, Transform::Scale(3, 1, 1)) / perimeter, 1, 1e-4);
}

/// Chi-square of how samples, weighted to uniform density, spread over equal parts of the shape:
/// with x = 1 / (pdf area), sum x over a part must be its share. Returns the p-value of the counts
/// of accepted samples, each accepted with probability proportional to x.
struct Spread {
  double p_value = 0;
  double area = 0;  ///< Mean of 1 / pdf.
};

Spread SpreadOf(const Geometry& geometry, int cells, const std::function<int(Vec3d)>& cell_of,
                const std::vector<double>& shares, bool ignore_pdf = false) {
  const OtherEmitter emitter = std::get<OtherEmitter>(geometry.emitters()[0].shape);
  Random random(77);
  constexpr int kSamples = 200000;
  std::vector<double> counts(cells, 0);
  double accepted = 0, area = 0, largest = 0;
  std::vector<EmitterPoint> points;
  points.reserve(kSamples);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2f u = {static_cast<float>(Uniform(random)), static_cast<float>(Uniform(random))};
    points.push_back(geometry.SampleEmitter(emitter, u));
    const double weight = 1 / static_cast<double>(points.back().pdf_area);
    area += weight;
    largest = std::max(largest, weight);
  }
  for (const EmitterPoint& point : points) {
    const double keep = ignore_pdf ? 1 : 1 / (point.pdf_area * largest);
    if (Uniform(random) >= keep) continue;
    ++accepted;
    ++counts[cell_of(ToDouble(point.p))];
  }
  double chi2 = 0;
  for (int i = 0; i < cells; ++i) {
    const double expected = accepted * shares[i];
    chi2 += (counts[i] - expected) * (counts[i] - expected) / expected;
  }
  const boost::math::chi_squared distribution(cells - 1);
  return {boost::math::cdf(boost::math::complement(distribution, chi2)), area / kSamples};
}

// Significance of each test below: 1e-4.
constexpr double kAlpha = 1e-4;

TEST(Emitters, SamplesAreUniformByArea) {
  // Parts of equal area of a disk: rings of equal area times sectors.
  const auto disk = MustBuildEmitter(DiskShape{0, 1, 0.5f, 270});
  const auto disk_cell = [](Vec3d p) {
    double phi = std::atan2(p.y, p.x);
    if (phi < 0) phi += 2 * M_PI;
    const int sector = std::min(static_cast<int>(phi / (1.5 * M_PI) * 8), 7);
    const double ring = (p.x * p.x + p.y * p.y - 0.25) / 0.75;
    return sector * 4 + std::clamp(static_cast<int>(ring * 4), 0, 3);
  };
  const std::vector<double> equal(32, 1.0 / 32);
  const Spread on_disk = SpreadOf(*disk, 32, disk_cell, equal);
  EXPECT_GT(on_disk.p_value, kAlpha);
  EXPECT_NEAR(on_disk.area, disk->emitters()[0].area, 1e-4);

  // Of a sphere's zone: heights times sectors.
  const auto zone = MustBuildEmitter(SphereShape{1, -0.5f, 0.9f, 180});
  const auto zone_cell = [](Vec3d p) {
    const int sector = std::clamp(static_cast<int>(std::atan2(p.y, p.x) / M_PI * 8), 0, 7);
    return sector * 4 + std::clamp(static_cast<int>((p.z + 0.5) / 1.4 * 4), 0, 3);
  };
  EXPECT_GT(SpreadOf(*zone, 32, zone_cell, equal).p_value, kAlpha);

  const auto cylinder = MustBuildEmitter(CylinderShape{2, 0, 1, 180});
  const auto cylinder_cell = [](Vec3d p) {
    const int sector = std::clamp(static_cast<int>(std::atan2(p.y, p.x) / M_PI * 8), 0, 7);
    return sector * 4 + std::clamp(static_cast<int>(p.z * 4), 0, 3);
  };
  EXPECT_GT(SpreadOf(*cylinder, 32, cylinder_cell, equal).p_value, kAlpha);
}

TEST(Emitters, SamplesOfStretchedShapesHaveTheDensityTheyClaim) {
  // The elliptic cylinder with axes 3 and 1, cut into eight sectors by the angle of its circle.
  const auto cylinder = MustBuildEmitter(CylinderShape{1, 0, 1, 360}, Transform::Scale(3, 1, 1));
  std::vector<double> shares;
  double sum = 0;
  for (int i = 0; i < 16; ++i) {
    shares.push_back(boost::math::quadrature::gauss_kronrod<double, 31>::integrate(
        [](double t) { return std::hypot(3 * std::sin(t), std::cos(t)); }, 2 * M_PI * i / 16,
        2 * M_PI * (i + 1) / 16));
    sum += shares.back();
  }
  for (double& share : shares) share /= sum;
  const auto cell = [](Vec3d p) {
    double phi = std::atan2(p.y, p.x / 3);
    if (phi < 0) phi += 2 * M_PI;
    return std::min(static_cast<int>(phi / (2 * M_PI) * 16), 15);
  };
  const Spread spread = SpreadOf(*cylinder, 16, cell, shares);
  EXPECT_GT(spread.p_value, kAlpha);
  EXPECT_NEAR(spread.area / sum, 1, 0.01);
  // The control: taken as uniform by area, the same samples fail.
  EXPECT_LT(SpreadOf(*cylinder, 16, cell, shares, true).p_value, kAlpha);
}

TEST(Emitters, DensityAtAPointIsThatOfSamplingIt) {
  Random random(5);
  const ShapeGeometry shapes[] = {SphereShape{1, -0.5f, 1, 270}, DiskShape{0.5f, 1, 0.25f, 360},
                                  CylinderShape{1, -1, 0.5f, 200}, kTwisted};
  for (const ShapeGeometry& shape : shapes) {
    for (int trial = 0; trial < 3; ++trial) {
      const auto geometry = MustBuildEmitter(shape, RandomAffine(random));
      ASSERT_EQ(geometry->emitters().size(), 1u);
      const OtherEmitter emitter = std::get<OtherEmitter>(geometry->emitters()[0].shape);
      for (int i = 0; i < 500; ++i) {
        const EmitterPoint point = geometry->SampleEmitter(
            emitter, {static_cast<float>(Uniform(random)), static_cast<float>(Uniform(random))});
        const float pdf = geometry->EmitterPdfArea(emitter, point.p);
        EXPECT_NEAR(pdf / point.pdf_area, 1, 1e-3);
        // A ray along the normal meets the emitter there, with the same side outside.
        const float reach = 0.01f;
        const Ray ray = {point.p + point.ng * reach, -point.ng};
        Hit hit;
        if (!geometry->Intersect(ray, &hit)) continue;  // At the border.
        if (std::abs(hit.t - reach) > 1e-4f) continue;  // Another part is nearer.
        const SurfacePoint surface = geometry->Surface(ray, hit);
        EXPECT_EQ(surface.light, 0);
        EXPECT_GT(Dot(surface.ng, point.ng), 0.999f);
      }
    }
  }
}

TEST(Emitters, SamplesOfPatchesHaveTheDensityTheyClaim) {
  const auto geometry = MustBuildEmitter(kTwisted);
  // Parts by the sign of x and y; their shares from a fine grid of the patch's own area.
  const auto cell = [](Vec3d p) { return (p.x > 0.1) + 2 * (p.y > -0.1); };
  std::vector<double> shares(4, 0);
  double sum = 0;
  constexpr int kGrid = 1000;
  const auto& c = kTwisted.positions;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const double u = (i + 0.5) / kGrid, v = (j + 0.5) / kGrid;
      const Vec3d p =
          Lerp(v, Lerp(u, ToDouble(c[0]), ToDouble(c[1])), Lerp(u, ToDouble(c[2]), ToDouble(c[3])));
      const Vec3d du = Lerp(v, ToDouble(c[1] - c[0]), ToDouble(c[3] - c[2]));
      const Vec3d dv = Lerp(u, ToDouble(c[2] - c[0]), ToDouble(c[3] - c[1]));
      const double area = Length(Cross(du, dv)) / (kGrid * kGrid);
      shares[cell(p)] += area;
      sum += area;
    }
  }
  for (double& share : shares) share /= sum;
  const Spread spread = SpreadOf(*geometry, 4, cell, shares);
  EXPECT_GT(spread.p_value, kAlpha);
  EXPECT_NEAR(spread.area / sum, 1, 0.005);
  EXPECT_NEAR(geometry->emitters()[0].area / sum, 1, 1e-3);
}

}  // namespace
}  // namespace strata::testing
