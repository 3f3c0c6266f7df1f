#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <tuple>
#include <vector>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"
#include "worker/bsdf/ggx.h"
#include "worker/sampling/alias_table.h"
#include "worker/sampling/blinn.h"
#include "worker/sampling/choose.h"
#include "worker/sampling/henyey_greenstein.h"
#include "worker/sampling/inversion.h"
#include "worker/sampling/jacobian.h"
#include "worker/sampling/piecewise_linear.h"
#include "worker/sampling/rejection.h"
#include "worker/sampling/routines.h"
#include "worker/sampling/spherical_rectangle.h"
#include "worker/sampling/spherical_triangle.h"
#include "worker/sampling/triangle_sqrt.h"
#include "worker/sampling/warp.h"
#include "worker/sampling/warp_inverse.h"

// What sampling routines must give by closed forms: means, areas, acceptance, and u itself by way
// of their inverses. tests/sampling/density_test.cpp tests their densities.

namespace strata {
namespace {

/// The mean of f over the midpoints of n equal parts of [0, 1).
template <typename Function>
double MidpointMean(const Function& f, int n = 1 << 14) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += f((static_cast<float>(i) + 0.5f) / static_cast<float>(n));
  return sum / n;
}

TEST(Inversion, MeansAreThoseOfTheDensities) {
  for (const float n : {0.0f, 0.5f, 2.0f, 10.0f}) {
    EXPECT_NEAR(MidpointMean([&](float u) { return SamplePower(u, n); }), (n + 1) / (n + 2), 1e-5);
  }
  for (const float a : {0.1f, 3.0f}) {
    EXPECT_NEAR(a * MidpointMean([&](float u) { return SampleExponential(u, a); }), 1, 1e-4);
    // Half of it lies below ln 2 / a.
    EXPECT_NEAR(a * SampleExponential(0.5f, a), std::numbers::ln2, 1e-6);
  }
  for (const auto& [a, b] : {std::pair{1.0f, 4.0f}, {0.0f, 1.0f}, {5.0f, 0.0f}, {2.0f, 2.0f}}) {
    EXPECT_NEAR(MidpointMean([a = a, b = b](float u) { return SampleLinear(u, a, b); }),
                (a + 2 * b) / (3 * (a + b)), 1e-6);
  }
  // A tent of height 2 over [0, 1): its variance is 1/24.
  const PiecewiseLinear1D tent({0, 1, 0});
  EXPECT_NEAR(MidpointMean([&](float u) { return std::pow(tent.Sample(u) - 0.5, 2); }), 1.0 / 24,
              1e-6);
  EXPECT_NEAR(tent.Pdf(0.5f), 2, 1e-6);
  EXPECT_EQ(PiecewiseLinear1D({0, 0, 0}).Pdf(0.3f), 1);
}

TEST(AliasTable, SharesAreExactAndNothingOfNoWeightIsChosen) {
  TestRandom random(1);
  for (const int n : {1, 2, 3, 17, 1000}) {
    std::vector<double> weights;
    double total = 0;
    for (int i = 0; i < n; ++i) {
      weights.push_back(i % 3 == 2 ? 0 : std::pow(10, 6 * random.Double() - 3));
      total += weights.back();
    }
    const AliasTable table(weights);
    double sum = 0;
    for (int i = 0; i < n; ++i) {
      EXPECT_NEAR(table.Probability(i), weights[i] / total, 1e-7);
      sum += table.Probability(i);
    }
    EXPECT_NEAR(sum, 1, 1e-6);
    // Over all of [0, 1) in even steps outcomes come in their proportion.
    constexpr int kSteps = 1 << 18;
    std::vector<double> shares(weights.size(), 0.0);
    for (int i = 0; i < kSteps; ++i) {
      const AliasTable::Choice choice = table.Choose((static_cast<float>(i) + 0.5f) / kSteps);
      ASSERT_GT(weights[choice.outcome], 0);
      ASSERT_GE(choice.fraction, 0);
      ASSERT_LT(choice.fraction, 1);
      shares[choice.outcome] += 1.0 / kSteps;
    }
    // Each bin may round once.
    for (int i = 0; i < n; ++i) EXPECT_NEAR(shares[i], weights[i] / total, (n + 1.0) / kSteps) << n;
  }
  const AliasTable even(std::vector<double>{0, std::nan("")});
  EXPECT_EQ(even.Probability(0), 0.5f);
}

TEST(Rejection, AcceptsPiQuartersOfTheSquareAndPiSixthsOfTheCube) {
  TestRandom random(5);
  const auto next = [&] { return random.Float(); };
  constexpr int kSamples = 1000000;
  const auto expect_acceptance = [&](const char* what, auto sample, double expected) {
    int64_t tries = 0;
    for (int i = 0; i < kSamples; ++i) tries += sample().tries;
    const double acceptance = static_cast<double>(kSamples) / static_cast<double>(tries);
    // By the delta method; a window of four standard errors.
    const double error = expected * std::sqrt((1 - expected) / kSamples);
    EXPECT_NEAR(acceptance, expected, 4 * error) << what;
    std::printf("%s: acceptance %.5f, expected %.5f +- %.5f\n", what, acceptance, expected, error);
    // Control: half a per cent less would be seen.
    EXPECT_GT(std::fabs(acceptance - 0.995 * expected), 4 * error);
  };
  expect_acceptance(
      "disk", [&] { return SampleDiskByRejection(next); }, std::numbers::pi / 4);
  expect_acceptance(
      "ball", [&] { return SampleBallByRejection(next); }, std::numbers::pi / 6);
  expect_acceptance(
      "sphere", [&] { return SampleSphereByRejection(next); }, std::numbers::pi / 6);
  // x of density 2x from uniform candidates, each taken with probability x.
  expect_acceptance(
      "ramp", [&] { return SampleByRejection(next, [&](float x) { return next() < x; }); }, 0.5);
}

TEST(Jacobian, DensitiesComeBackAndIntegrateToOne) {
  EXPECT_FLOAT_EQ(PolarToAreaPdf(AreaToPolarPdf(0.3f, 0.7f), 0.7f), 0.3f);
  EXPECT_FLOAT_EQ(SphericalToVolumePdf(VolumeToSphericalPdf(0.3f, 0.7f, 0.4f), 0.7f, 0.4f), 0.3f);
  EXPECT_FLOAT_EQ(AnglesToSolidAnglePdf(SolidAngleToAnglesPdf(0.3f, 0.7f), 0.7f), 0.3f);
  EXPECT_EQ(PolarToAreaPdf(1, 0), 0);
  const auto pi = std::numbers::pi;
  const double disk = 2 * pi * MidpointMean([](float r) { return AreaToPolarPdf(kInvPi, r); });
  const double sphere = 2 * pi * pi * MidpointMean([](float x) {
                          return SolidAngleToAnglesPdf(UniformSpherePdf(), Sin(kPi * x));
                        });
  const double ball =
      4 * pi * MidpointMean([](float r) { return VolumeToSphericalPdf(0.75f * kInvPi, r, 1); });
  EXPECT_NEAR(disk, 1, 1e-5);
  EXPECT_NEAR(sphere, 1, 1e-5);
  EXPECT_NEAR(ball, 1, 1e-5);
  // A uniform half vector reflects the normal into directions of density 1 / (8 pi cos(theta_h)).
  EXPECT_FLOAT_EQ(HalfVectorToReflectedPdf(UniformHemispherePdf(), 0.5f), 1 / (4 * kPi));
}

TEST(Warp, MeanCosinesAreThoseOfTheDensities) {
  const auto mean_z = [](auto sample) {
    return MidpointMean([&](float u) { return sample(Vec2f{u, 0.25f}).z; });
  };
  EXPECT_NEAR(mean_z(SampleUniformHemisphere), 0.5, 1e-6);
  EXPECT_NEAR(mean_z(SampleUniformSphere), 0, 1e-6);
  EXPECT_NEAR(mean_z([](Vec2f u) { return SampleUniformCone(u, 0.2f); }), 0.9, 1e-6);
  for (const float g : {-0.99f, -0.5f, -1e-5f, 0.0f, 1e-3f, 0.7f, 0.99f}) {
    EXPECT_NEAR(mean_z([g](Vec2f u) { return SampleHenyeyGreenstein(u, g); }), g, 1e-5) << g;
  }
  for (const float n : {0.0f, 1.0f, 30.0f, 10000.0f}) {
    EXPECT_NEAR(mean_z([n](Vec2f u) { return SampleBlinn(u, n); }), (n + 1.0) / (n + 2.0), 1e-6);
  }
  // Malley: what is uniform on the disk has mean cosine 2/3 above it.
  double sum = 0;
  constexpr int kSide = 512;
  for (int i = 0; i < kSide * kSide; ++i) {
    sum += SampleCosineHemisphere({(i % kSide + 0.5f) / kSide, (i / kSide + 0.5f) / kSide}).z;
  }
  EXPECT_NEAR(sum / (kSide * kSide), 2.0 / 3, 1e-4);
}

/// The largest ratio of the axes of the ellipses that a map makes of small circles.
template <typename Map>
double WorstStretch(const Map& map) {
  constexpr int kSide = 64;
  constexpr float kStep = 1e-3f;
  double worst = 1;
  for (int i = 0; i < kSide * kSide; ++i) {
    // Off the diagonals, where maps have creases.
    const Vec2f u = {(i % kSide + 0.5f) / kSide, (i / kSide + 0.3f) / kSide};
    const Vec2f p = map(u), px = map({u.x + kStep, u.y}), py = map({u.x, u.y + kStep});
    const double a = px.x - p.x, b = py.x - p.x, c = px.y - p.y, d = py.y - p.y;
    const double trace = a * a + b * b + c * c + d * d, determinant = std::fabs(a * d - b * c);
    const double root = std::sqrt(std::max(0.0, trace * trace - 4 * determinant * determinant));
    worst = std::max(worst, std::sqrt((trace + root) / std::max(trace - root, 1e-30)));
  }
  return worst;
}

TEST(Warp, LowDistortionMapsStretchLittle) {
  EXPECT_LT(WorstStretch(SampleConcentricDisk), 2.5);
  EXPECT_GT(WorstStretch(SamplePolarDisk), 8);
  EXPECT_LT(WorstStretch(SampleTriangle), 2.7);
  EXPECT_GT(WorstStretch(SampleTriangleSqrt), 50);
}

/// Sample and then Invert, over the square but for its rim.
template <typename Sample, typename Invert>
void ExpectInverse(const char* what, const Sample& sample, const Invert& invert,
                   double tolerance = 2e-5) {
  TestRandom random(7);
  for (int i = 0; i < 2000; ++i) {
    const Vec2f u = {0.005f + 0.99f * random.Float(), 0.005f + 0.99f * random.Float()};
    const Vec2f back = invert(sample(u));
    ASSERT_NEAR(back.x, u.x, tolerance) << what << " at " << u.x << " " << u.y;
    ASSERT_NEAR(back.y, u.y, tolerance) << what << " at " << u.x << " " << u.y;
  }
}
/// The same of one dimension.
template <typename Sample, typename Invert>
void ExpectInverse1D(const char* what, const Sample& sample, const Invert& invert) {
  ExpectInverse(
      what,
      [&](Vec2f u) {
        return Vec2f{sample(u.x), u.y};
      },
      [&](Vec2f p) {
        return Vec2f{invert(p.x), p.y};
      });
}

TEST(Inverses, OfInversion) {
  ExpectInverse1D(
      "power", [](float u) { return SamplePower(u, 3); },
      [](float x) { return InvertPower(x, 3); });
  ExpectInverse1D(
      "exponential", [](float u) { return SampleExponential(u, 2); },
      [](float x) { return InvertExponential(x, 2); });
  ExpectInverse1D(
      "linear", [](float u) { return SampleLinear(u, 3, 1); },
      [](float x) { return InvertLinear(x, 3, 1); });
  const PiecewiseConstant1D constant(std::vector<double>{1, 5, 0.1, 2});
  ExpectInverse1D(
      "piecewise constant", [&](float u) { return constant.Sample(u).x; },
      [&](float x) { return constant.Invert(x); });
  const PiecewiseLinear1D linear({1, 5, 0.1f, 2});
  ExpectInverse1D(
      "piecewise linear", [&](float u) { return linear.Sample(u); },
      [&](float x) { return linear.Invert(x); });
  const std::array<float, 4> corners = {1, 0.5f, 3, 2};
  ExpectInverse(
      "bilinear", [&](Vec2f u) { return SampleBilinear(u, corners); },
      [&](Vec2f p) { return InvertBilinear(p, corners); });
  const PiecewiseConstant2D plane(std::vector<float>{1, 2, 3, 0.5f, 4, 1}, 3, 2);
  ExpectInverse(
      "piecewise constant 2-D",
      [&](Vec2f u) {
        float pdf;
        return plane.Sample(u, &pdf);
      },
      [&](Vec2f p) { return plane.Invert(p); });
}

TEST(Inverses, OfWarps) {
  ExpectInverse("polar disk", SamplePolarDisk, InvertPolarDisk);
  ExpectInverse("concentric disk", SampleConcentricDisk, InvertConcentricDisk);
  ExpectInverse("triangle", SampleTriangle, InvertTriangle);
  ExpectInverse("triangle, square root", SampleTriangleSqrt, InvertTriangleSqrt);
  ExpectInverse("uniform hemisphere", SampleUniformHemisphere, InvertUniformHemisphere);
  ExpectInverse("cosine hemisphere", SampleCosineHemisphere, InvertCosineHemisphere);
  ExpectInverse("sphere", SampleUniformSphere, InvertUniformSphere);
  ExpectInverse(
      "cone", [](Vec2f u) { return SampleUniformCone(u, 1e-4f); },
      [](Vec3f w) { return InvertUniformCone(w, 1e-4f); });
  for (const float g : {-0.7f, 0.0f, 1e-4f, 0.95f}) {
    ExpectInverse(
        "Henyey-Greenstein", [g](Vec2f u) { return SampleHenyeyGreenstein(u, g); },
        [g](Vec3f w) { return InvertHenyeyGreenstein(w, g); });
  }
  ExpectInverse(
      "Blinn", [](Vec2f u) { return SampleBlinn(u, 20); },
      [](Vec3f h) { return InvertBlinn(h, 20); });
  const Ggx ggx = Ggx::FromAlpha(0.4f, 0.2f);
  const Vec3f wo = Normalize(Vec3f{0.7f, 0.3f, 0.4f});
  ExpectInverse(
      "visible normals", [&](Vec2f u) { return ggx.SampleVisibleNormal(wo, u); },
      [&](Vec3f m) { return ggx.InvertVisibleNormal(wo, m); });
}

TEST(JobRoutines, ArePutBeforeTheShippedMaps) {
  TestRandom random(70);
  for (int i = 0; i < 1000; ++i) {
    const Vec2f u = random.Float2();
    const Vec2f b = SampleTriangle(TriangleNumbers(SamplingRoutines::kPlain, u));
    const Vec2f wanted = SampleTriangleSqrt(u);
    EXPECT_NEAR(b.x, wanted.x, 2e-7);
    EXPECT_NEAR(b.y, wanted.y, 2e-7);
    const Vec2f d = SampleDiskBy(SamplingRoutines::kPlain, u), polar = SamplePolarDisk(u);
    EXPECT_EQ(d.x, polar.x);
    EXPECT_EQ(d.y, polar.y);
    const Vec2f kept = TriangleNumbers(SamplingRoutines::kPreserving, u);
    EXPECT_EQ(kept.x, u.x);
    EXPECT_EQ(kept.y, u.y);
  }
}

TEST(ChooseByWeight, GoesByTheWeightsAndTakesNothingOfNone) {
  const std::vector<float> weights = {0, 2, 0, 1, 0};
  const auto choose = [&](float* left) {
    return ChooseByWeight(
        weights.size(), [&](size_t i) { return weights[i]; }, left);
  };
  for (const auto& [number, outcome, over] : {std::tuple{0.0f, 1u, 0.0f},
                                              {1.5f, 1u, 1.5f},
                                              {2.0f, 3u, 0.0f},
                                              {2.75f, 3u, 0.75f},
                                              {3.0f, 3u, 1.0f}}) {
    float left = number;
    EXPECT_EQ(choose(&left), outcome) << number;
    EXPECT_EQ(left, over) << number;
  }
}

SphericalRectangle RectangleSeenFrom(Vec3f corner, Vec3f edge1, Vec3f edge2, Vec3f from) {
  const RectangleScales scales = ScalesOf(edge1, edge2);
  return {corner,        edge1, scales.edge1, edge2, scales.edge2, Normalize(Cross(edge1, edge2)),
          scales.length, from};
}

TEST(Inverses, OfSphericalShapes) {
  const SphericalTriangle triangle({1, 0, 0.1f}, {0.5f, 1, 0}, {0.2f, 0.1f, 1}, {0.1f, 0.1f, 0});
  ExpectInverse(
      "spherical triangle", [&](Vec2f u) { return triangle.Sample(u); },
      [&](Vec3f w) { return triangle.Invert(w); });
  const SphericalRectangle rectangle = RectangleSeenFrom({-1, -1, 1}, {3, 0, 0}, {0, 2, 0}, {});
  ExpectInverse(
      "spherical rectangle", [&](Vec2f u) { return rectangle.Sample(u); },
      [&](Vec2f p) { return rectangle.Invert(p); });
}

TEST(SphericalTriangle, SolidAnglesAreThoseOfClosedForms) {
  const double pi = std::numbers::pi;
  // An octant, and a hemisphere's quarter cut in two.
  EXPECT_NEAR(SphericalTriangle({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {}).solid_angle(), pi / 2, 1e-12);
  EXPECT_NEAR(SphericalTriangle({1, 0, 0}, {1, 1, 0}, {0, 0, 1}, {}).solid_angle(), pi / 4, 1e-12);
  // A small one is as good as flat.
  constexpr float kSmall = 1e-4f;
  const SphericalTriangle small({0, 0, 1}, {kSmall, 0, 1}, {0, kSmall, 1}, {});
  EXPECT_NEAR(small.solid_angle() / (0.5 * kSmall * kSmall), 1, 1e-7);
  // Half the numbers go to half of it: the part before the middle of the arc AC, by symmetry.
  const SphericalTriangle octant({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {});
  const Vec3f middle = octant.Sample({0.5f, 0.7f});
  EXPECT_NEAR(middle.x, middle.z, 1e-6);
  // Towards B the cosine is uniform.
  EXPECT_NEAR(middle.y, 0.3, 1e-6);
  // The edges of the square are corners and edges of the triangle, and finite.
  for (const float u : {0.0f, 0.5f, 1 - 0x1p-24f}) {
    for (const float v : {0.0f, 1 - 0x1p-24f}) {
      EXPECT_NEAR(LengthSquared(octant.Sample({u, v})), 1, 1e-6);
      EXPECT_NEAR(LengthSquared(small.Sample({u, v})), 1, 1e-6);
    }
  }
  EXPECT_NEAR(octant.Sample({0.3f, 0}).y, 1, 1e-6);
}

TEST(SphericalRectangle, ItsSolidAngleIsThatOfTwoTriangles) {
  const Vec3f corner = {-0.4f, 0.3f, 0.8f}, u = {1, 0, 0}, v = {0, 0.6f, 0.8f};
  const Vec3f from = {0.1f, 0, 0.2f};
  const SphericalRectangle rectangle = RectangleSeenFrom(corner, u * 1.5f, v * 0.5f, from);
  const Vec3f a = corner + u * 1.5f, b = corner + v * 0.5f, c = a + v * 0.5f;
  const double sum = SphericalTriangle(corner, a, b, from).solid_angle() +
                     SphericalTriangle(a, c, b, from).solid_angle();
  EXPECT_NEAR(rectangle.solid_angle, sum, 1e-6);
  // A face of a cube from its centre is a sixth of the sphere.
  const SphericalRectangle face = RectangleSeenFrom({-1, -1, 1}, {2, 0, 0}, {0, 2, 0}, {});
  EXPECT_NEAR(face.solid_angle, 4 * std::numbers::pi / 6, 1e-6);
}

TEST(SphericalRectangle, ItsSolidAngleIsThatOfTheClosedFormFromAnywhere) {
  // Rectangles with one corner before the point, added with their signs.
  const auto closed_form = [](double x0, double x1, double y0, double y1, double z) {
    const auto corner = [z](double x, double y) {
      return Atan2(x * y, z * std::sqrt(x * x + y * y + z * z));
    };
    return corner(x1, y1) - corner(x0, y1) - corner(x1, y0) + corner(x0, y0);
  };
  TestRandom random(5);
  const auto power = [&](double least, double most) {
    return static_cast<float>(std::pow(10.0, least + (most - least) * random.Double()));
  };
  double worst = 0;
  for (int i = 0; i < 100000; ++i) {
    // Sizes of all kinds, long ones, points beside and before them and nearly in their planes.
    const float size = power(-6, 6), stretch = power(-2, 2);
    const float length1 = size * stretch, length2 = size / stretch;
    const float x0 = length1 * (2 * random.Float() - 1.5f);
    const float y0 = length2 * (2 * random.Float() - 1.5f);
    const float z = size * power(-4, 0);
    const SphericalRectangle rectangle =
        RectangleSeenFrom({x0, y0, -z}, {length1, 0, 0}, {0, length2, 0}, {});
    const double expected =
        closed_form(rectangle.x0, rectangle.x1, rectangle.y0, rectangle.y1, -double{rectangle.z0});
    worst = std::max(worst, std::abs(rectangle.solid_angle - expected));
  }
  EXPECT_LT(worst, 1e-6);
}

}  // namespace
}  // namespace strata
