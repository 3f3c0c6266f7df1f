#include "worker/sampling/filter.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/sampling/density_cases.h"
#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"

// What the filters are; that their samples follow them is density_test.cpp's.

namespace strata {
namespace {

/// The definitions of pbrt-v4, not normalised.
double Definition(const FilterSpec& spec, double radius, double x) {
  x = std::fabs(x);
  if (x > radius) return 0;
  switch (spec.kind) {
    case FilterKind::kBox:
      return 1;
    case FilterKind::kTriangle:
      return radius - x;
    case FilterKind::kGaussian: {
      const auto g = [&](double t) { return std::exp(-t * t / (2 * spec.sigma * spec.sigma)); };
      return g(x) - g(radius);
    }
    case FilterKind::kMitchell:
      break;
  }
  const double t = 2 * x / radius, b = spec.b, c = spec.c;
  if (t < 1) {
    return ((12 - 9 * b - 6 * c) * t * t * t + (-18 + 12 * b + 6 * c) * t * t + 6 - 2 * b) / 6;
  }
  return ((-b - 6 * c) * t * t * t + (6 * b + 30 * c) * t * t + (-12 * b - 48 * c) * t + 8 * b +
          24 * c) /
         6;
}

TEST(Filter, IsTheNormalisedDefinition) {
  for (const FilterSpec& spec : TestedFilters()) {
    const FilterAxis axis(spec.kind, spec.radius_x, spec);
    constexpr int kSteps = 20000;
    double integral = 0;
    for (int i = 0; i < kSteps; ++i) {
      integral += Definition(spec, spec.radius_x, spec.radius_x * (2 * (i + 0.5) / kSteps - 1));
    }
    integral *= 2 * spec.radius_x / kSteps;
    const double peak = Definition(spec, spec.radius_x, 0) / integral;
    for (int i = 0; i < 1000; ++i) {
      const double x = spec.radius_x * (2 * (i + 0.5) / 1000 - 1);
      EXPECT_NEAR(axis.Eval(static_cast<float>(x)), Definition(spec, spec.radius_x, x) / integral,
                  1e-3 * peak)
          << ToString(spec.kind) << " at " << x;
    }
  }
}

// Through all 2^24 numbers of an axis, by a stratified part of them: a constant stays constant.
TEST(Filter, WeightsAverageToOne) {
  for (const FilterSpec& spec : TestedFilters()) {
    const FilterAxis axis(spec.kind, spec.radius_x, spec);
    double sum = 0, offset = 0;
    constexpr int kSteps = 1 << 24;
    constexpr int kStride = 16;
    for (int i = kStride / 2; i < kSteps; i += kStride) {
      const FilterAxis::Point p = axis.Sample(static_cast<float>(i) * 0x1p-24f);
      sum += p.weight;
      offset += p.weight * p.offset;
    }
    EXPECT_NEAR(sum * kStride / kSteps, 1, 2e-4) << ToString(spec.kind);
    EXPECT_NEAR(offset * kStride / kSteps, 0, 5e-4) << ToString(spec.kind);
    // Non-negative filters have weight exactly 1.
    if (spec.kind != FilterKind::kMitchell) {
      EXPECT_EQ(axis.Sample(0.3f).weight, 1);
    }
  }
}

// Filtering a smooth image by samples gives the integral of filter times image.
TEST(Filter, SignedWeightsReconstruct) {
  for (const FilterSpec& spec : TestedFilters()) {
    const FilterSampler filter(spec);
    const auto image = [](double x, double y) { return 1 + x * x + 0.5 * x * y * y; };
    TestRandom random(2);
    MeanWithError mean;
    for (int i = 0; i < 400000; ++i) {
      const FilterSample s = filter.Sample(random.Float2());
      mean.Add(s.weight * image(s.offset.x, s.offset.y));
    }
    double exact = 0;
    constexpr int kSteps = 200;
    for (int i = 0; i < kSteps; ++i) {
      for (int j = 0; j < kSteps; ++j) {
        const double x = spec.radius_x * (2 * (i + 0.5) / kSteps - 1);
        const double y = spec.radius_y * (2 * (j + 0.5) / kSteps - 1);
        exact += image(x, y) * filter.Eval({static_cast<float>(x), static_cast<float>(y)});
      }
    }
    exact *= 4 * spec.radius_x * spec.radius_y / (kSteps * kSteps);
    EXPECT_NEAR(mean.mean(), exact, 4 * mean.error() + 1e-3) << ToString(spec.kind);
  }
}

}  // namespace
}  // namespace strata
