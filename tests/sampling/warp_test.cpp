#include "worker/sampling/warp.h"

#include <gtest/gtest.h>

#include "tests/statistics/direction_test.h"
#include "tests/statistics/random.h"

namespace strata {
namespace {

constexpr int kDirectionTests = 8;

template <typename Sample, typename Pdf>
void ExpectDirections(const Sample& sample, const Pdf& pdf, const char* what) {
  TestRandom random(1);
  const auto result = TestDirections(
      [&]() -> std::optional<Vec3f> { return sample(random.Float2()); }, pdf, 1000000);
  EXPECT_GT(result.chi_square.p, SidakLevel(0.01, kDirectionTests))
      << what << ": " << result.chi_square.statistic << " / " << result.chi_square.degrees;
  EXPECT_NEAR(result.integral, 1, 1e-4) << what;
}

TEST(Warp, DirectionsFollowTheirDensities) {
  ExpectDirections(
      SampleCosineHemisphere, [](Vec3f w) { return CosineHemispherePdf(w.z); },
      "cosine hemisphere");
  ExpectDirections(
      SampleUniformHemisphere, [](Vec3f w) { return w.z > 0 ? UniformHemispherePdf() : 0; },
      "uniform hemisphere");
  ExpectDirections(
      SampleUniformSphere, [](Vec3f) { return UniformSpherePdf(); }, "uniform sphere");
  for (const double angle : {0.001, 0.1, 1.0, 1.5}) {
    const double sine = std::sin(angle);
    const float one_minus_cos = OneMinusCosFromSinSquared(static_cast<float>(sine * sine));
    EXPECT_NEAR(one_minus_cos / (2 * std::pow(std::sin(angle / 2), 2)), 1, 2e-6) << angle;
    // The cone's edge is no edge of the cells, so here the share within part of it is tested.
    TestRandom random(2);
    std::vector<double> counts(64, 0.0);
    constexpr int kSamples = 1000000;
    for (int i = 0; i < kSamples; ++i) {
      const Vec3f w = SampleUniformCone(random.Float2(), one_minus_cos);
      const double t = direction_test_detail::ToPolar(w).t / one_minus_cos;
      const double turn = direction_test_detail::ToPolar(w).phi / (2 * std::numbers::pi) + 0.5;
      ASSERT_LT(t, 1 + 1e-5);
      ++counts[std::min(7, static_cast<int>(t * 8)) * 8 + std::min(7, static_cast<int>(turn * 8))];
    }
    const std::vector<double> expected(64, kSamples / 64.0);
    EXPECT_GT(ChiSquareTest(counts, expected).p, SidakLevel(0.01, kDirectionTests)) << angle;
    EXPECT_NEAR(UniformConePdf(one_minus_cos) * 2 * std::numbers::pi * one_minus_cos, 1, 1e-6);
  }
}

TEST(WarpControl, AWrongDensityIsCaught) {
  TestRandom random(1);
  const auto uniform = [&]() -> std::optional<Vec3f> {
    return SampleUniformHemisphere(random.Float2());
  };
  const auto tilted = [](Vec3f w) { return w.z > 0 ? (1 + 0.05f * (w.z - 0.5f)) / (2 * kPi) : 0; };
  EXPECT_LT(TestDirections(uniform, tilted, 1000000).chi_square.p, 1e-4);
}

/// Counts of points of the unit square's image in a 16 by 16 grid of `unmap`ped cells.
template <typename Map>
double UniformityOverGrid(const Map& to_unit_square) {
  TestRandom random(4);
  constexpr int kSamples = 1000000;
  std::vector<double> counts(256, 0.0);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2f p = to_unit_square(random.Float2());
    const int x = std::clamp(static_cast<int>(p.x * 16), 0, 15);
    const int y = std::clamp(static_cast<int>(p.y * 16), 0, 15);
    ++counts[y * 16 + x];
  }
  return ChiSquareTest(counts, std::vector<double>(256, kSamples / 256.0)).p;
}

TEST(Warp, DiskAndTriangleAreUniformByArea) {
  // Radius squared and angle are uniform on the disk.
  EXPECT_GT(UniformityOverGrid([](Vec2f u) {
              const Vec2f p = SampleConcentricDisk(u);
              return Vec2f{p.x * p.x + p.y * p.y, std::atan2(p.y, p.x) / (2 * kPi) + 0.5f};
            }),
            SidakLevel(0.01, 2));
  // b0 = 1 - sqrt(v) and b1 = w sqrt(v) are uniform on the triangle when v and w are.
  EXPECT_GT(UniformityOverGrid([](Vec2f u) {
              const Vec2f b = SampleTriangle(u);
              EXPECT_GE(std::min({b.x, b.y, 1 - b.x - b.y}), -1e-6f);
              return Vec2f{(1 - b.x) * (1 - b.x), b.y / (1 - b.x)};
            }),
            SidakLevel(0.01, 2));
  // Control: radius itself is not uniform.
  EXPECT_LT(UniformityOverGrid([](Vec2f u) {
              const Vec2f p = SampleConcentricDisk(u);
              return Vec2f{std::sqrt(p.x * p.x + p.y * p.y), 0.5f};
            }),
            1e-6);
}

TEST(Warp, EdgesOfTheSquareStayInRange) {
  constexpr float kLast = 1 - 0x1p-24f;
  for (const float x : {0.0f, 0.5f, kLast}) {
    for (const float y : {0.0f, 0.5f, kLast}) {
      for (const Vec3f w : {SampleCosineHemisphere({x, y}), SampleUniformHemisphere({x, y}),
                            SampleUniformSphere({x, y}), SampleUniformCone({x, y}, 1e-12f)}) {
        EXPECT_NEAR(LengthSquared(w), 1, 1e-6);
      }
      const Vec2f d = SampleConcentricDisk({x, y});
      EXPECT_LE(d.x * d.x + d.y * d.y, 1 + 1e-6f);
    }
  }
  EXPECT_EQ(SampleConcentricDisk({0.5f, 0.5f}).x, 0);
}

TEST(Warp, HeuristicsSumToOne) {
  for (const float a : {1e-30f, 0.1f, 1.0f, 1e20f}) {
    for (const float b : {0.0f, 1e-30f, 2.0f, 1e30f}) {
      EXPECT_NEAR(PowerHeuristic(a, b) + PowerHeuristic(b, a), 1, 1e-6);
      EXPECT_NEAR(BalanceHeuristic(a, b) + BalanceHeuristic(b, a), 1, 1e-6);
    }
  }
  EXPECT_FLOAT_EQ(PowerHeuristic(3, 1), 0.9f);
  EXPECT_FLOAT_EQ(BalanceHeuristic(3, 1), 0.75f);
  EXPECT_EQ(PowerHeuristic(0, 0), 0);
  EXPECT_EQ(PowerHeuristic(1, HUGE_VALF), 0);
}

}  // namespace
}  // namespace strata
