#include "worker/geometry/noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/statistics/random.h"

namespace strata {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Vec3d Gradient(Vec3d p) {
  constexpr double kStep = 1e-5;
  const auto slope = [&](Vec3d step) {
    return (Noise(p + step) - Noise(p + step * -1.0)) / (2 * kStep);
  };
  return {slope({kStep, 0, 0}), slope({0, kStep, 0}), slope({0, 0, kStep})};
}

TEST(NoiseTest, VanishesAtLatticePointsWhoseGradientsAreEvenlySpread) {
  // The table holds each of 0 to 255 once, so each of 16 gradients comes 16 times on a line of 256.
  std::array<int, 3> zeros = {};
  for (int x = -100; x < 156; ++x) {
    const Vec3d p = {static_cast<double>(x), 7, -3};
    EXPECT_EQ(Noise(p), 0);
    const Vec3d g = Gradient(p);
    const std::array<double, 3> components = {g.x, g.y, g.z};
    for (size_t i = 0; i < 3; ++i) {
      EXPECT_NEAR(std::fabs(components[i]), std::round(std::fabs(components[i])), 1e-4);
      if (std::fabs(components[i]) < 0.5) ++zeros[i];
    }
    EXPECT_NEAR(std::fabs(g.x) + std::fabs(g.y) + std::fabs(g.z), 2, 1e-4);
  }
  EXPECT_EQ(zeros, (std::array<int, 3>{96, 64, 96}));
}

TEST(NoiseTest, IsSmoothBoundedAndPeriodic) {
  TestRandom random(1);
  double sum = 0, squares = 0;
  constexpr int kPoints = 20000;
  for (int i = 0; i < kPoints; ++i) {
    const auto coordinate = [&] { return 60 * static_cast<double>(random.Float()) - 30; };
    const Vec3d p = {coordinate(), coordinate(), coordinate()};
    const double noise = Noise(p);
    EXPECT_LE(std::fabs(noise), 1.1);
    EXPECT_NEAR(Noise(p + Vec3d{256, -512, 256}), noise, 1e-9);
    // Across the face of a cell as well.
    const Vec3d face = {std::round(p.x), p.y, p.z};
    EXPECT_NEAR(Noise(face + Vec3d{-1e-9, 0, 0}), Noise(face + Vec3d{1e-9, 0, 0}), 1e-8);
    sum += noise;
    squares += noise * noise;
  }
  EXPECT_NEAR(sum / kPoints, 0, 0.02);
  EXPECT_NEAR(std::sqrt(squares / kPoints), 0.3, 0.1);
  for (const double bad : {std::nan(""), kInfinity, -kInfinity}) EXPECT_EQ(Noise({0.5, bad, 0}), 0);
  EXPECT_LE(std::fabs(Noise({1e30, -1e300, 0.5})), 1.1);
}

TEST(NoiseTest, OctavesAddUp) {
  const Vec3d p = {0.3, 1.6, -2.2};
  EXPECT_EQ(FractalNoise(p, 0.5, 0), 0);
  EXPECT_EQ(FractalNoise(p, 0.5, 1), Noise(p));
  EXPECT_DOUBLE_EQ(FractalNoise(p, 0.25, 2), Noise(p) + 0.25 * Noise(p * 1.99));
  EXPECT_DOUBLE_EQ(Turbulence(p, 0.25, 2),
                   std::fabs(Noise(p)) + 0.25 * std::fabs(Noise(p * 1.99)) + 0.2 * 0.25 * 0.25);
}

TEST(NoiseTest, MarbleHasItsColours) {
  NoiseTexture marble = {.kind = NoiseTexture::Kind::kMarble, .scale = 2, .variation = 0};
  // The sine is -1: the first colour.
  const Rgb pale = EvalNoise(marble, {5, -std::numbers::pi / 4, 9});
  EXPECT_NEAR(pale.r, 1.5 * 0.58, 1e-5);
  EXPECT_NEAR(pale.b, 1.5 * 0.6, 1e-5);
  // It is 1: the end of the last piece, a sixth of which comes from each of four colours.
  EXPECT_NEAR(EvalNoise(marble, {5, std::numbers::pi / 4, 9}).r, 1.5 * 0.58, 1e-5);
  // Between the two there are dark veins, and the noise moves them.
  float darkest = 1;
  for (int i = 0; i < 100; ++i)
    darkest = std::min(darkest, EvalNoise(marble, {0, -0.8 + 0.016 * i, 0}).r);
  EXPECT_LT(darkest, 0.6f);
  const Vec3d p = {0.3, 0.2, 0.6};
  const Rgb still = EvalNoise(marble, p);
  marble.variation = 3;
  EXPECT_NE(EvalNoise(marble, p), still);
  // Places that are too far, or none, have a colour all the same.
  const Rgb far = EvalNoise(marble, {0, 1e200, 0});
  EXPECT_EQ(EvalNoise(marble, {0, std::nan(""), 0}), far);
  EXPECT_GT(far.r, 0);
}

TEST(NoiseTest, TwoInFiveCellsHaveADot) {
  TestRandom random(2);
  int inside = 0;
  constexpr int kPoints = 200000;
  for (int i = 0; i < kPoints; ++i)
    inside += IsInDot({250 * random.Float(), 250 * random.Float()}) ? 1 : 0;
  // In the middle of a cell eight gradients give -1, 0 or 1 eighths with odds of 1, 2 and 1, as
  // 16 coins do: their sum is above 0 in this part of the cells.
  const double cells = 0.5 * (1 - 12870.0 / 65536);
  const double expected = cells * std::numbers::pi * 0.35 * 0.35;
  EXPECT_NEAR(static_cast<double>(inside) / kPoints, expected, 0.05 * expected);
  // No dot crosses the border of its cell, whose centre is a lattice point.
  for (int i = 0; i < 1000; ++i) {
    const float along = 100 * random.Float();
    EXPECT_FALSE(IsInDot({along, 3.5f}));
    EXPECT_FALSE(IsInDot({-2.5f, along}));
  }
}

}  // namespace
}  // namespace strata
