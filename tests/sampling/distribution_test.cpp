#include "worker/sampling/distribution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"

namespace strata {
namespace {

TEST(PiecewiseConstant1D, SamplesFollowTheWeightsAndTheRestIsUniform) {
  const std::vector<double> weights = {1, 0, 3, 0.001, 0, 10, 2, 0};
  const PiecewiseConstant1D distribution(weights);
  double total = 0;
  for (const double w : weights) total += w;
  TestRandom random(1);
  constexpr int kSamples = 1000000, kParts = 8;
  std::vector<double> counts(weights.size() * kParts, 0.0), expected;
  for (int i = 0; i < kSamples; ++i) {
    const PiecewiseConstant1D::Point point = distribution.Sample(random.Float());
    ASSERT_EQ(static_cast<int>(point.x * distribution.cells()), point.choice.cell);
    ASSERT_EQ(point.choice.probability, distribution.Probability(point.choice.cell));
    ASSERT_EQ(distribution.Pdf(point.x), point.choice.probability * distribution.cells());
    ASSERT_GT(point.choice.probability, 0);
    ++counts[point.choice.cell * kParts + static_cast<int>(point.choice.fraction * kParts)];
  }
  for (const double w : weights) {
    for (int i = 0; i < kParts; ++i) expected.push_back(kSamples * w / total / kParts);
  }
  EXPECT_GT(ChiSquareTest(counts, expected).p, 0.01);
  // Control: another weight is noticed.
  std::vector<double> wrong = expected;
  for (int i = 0; i < kParts; ++i) {
    wrong[i] *= 1.05;
    wrong[5 * kParts + i] -= 0.05 * expected[i];
  }
  EXPECT_LT(ChiSquareTest(counts, wrong).p, 1e-4);
}

TEST(PiecewiseConstant1D, ProbabilitiesSumToOneExactlyAndMissNoCell) {
  TestRandom random(2);
  for (const int cells : {1, 2, 3, 1000, 8192}) {
    std::vector<double> weights;
    // Eighteen orders of magnitude, and zeros.
    for (int i = 0; i < cells; ++i) {
      weights.push_back(i % 5 == 4 ? 0 : std::pow(10.0, 18 * random.Double() - 9));
    }
    const PiecewiseConstant1D distribution(weights);
    double sum = 0;
    for (int i = 0; i < cells; ++i) {
      sum += distribution.Probability(i);
      EXPECT_EQ(distribution.Probability(i) > 0, weights[i] > 0) << i;
    }
    EXPECT_EQ(sum, 1);
    for (const float u : {0.0f, 0.5f, 1 - 0x1p-24f}) {
      const PiecewiseConstant1D::Point point = distribution.Sample(u);
      EXPECT_GT(weights[point.choice.cell], 0);
      EXPECT_LT(point.x, 1);
    }
  }
}

TEST(PiecewiseConstant1D, StratifiedNumbersStayStratified) {
  // Inversion is monotone, so cells get their share to within one point.
  const PiecewiseConstant1D distribution(std::vector<double>{1, 2, 5});
  std::vector<int> counts(3, 0);
  float last = -1;
  for (int i = 0; i < 800; ++i) {
    const PiecewiseConstant1D::Point point = distribution.Sample((i + 0.5f) / 800);
    EXPECT_GE(point.x, last);
    last = point.x;
    ++counts[point.choice.cell];
  }
  EXPECT_EQ(counts, (std::vector<int>{100, 200, 500}));
}

TEST(PiecewiseConstant1D, NoWeightAtAllIsUniform) {
  for (const double nothing : {0.0, -1.0, std::nan("")}) {
    const PiecewiseConstant1D distribution(std::vector<double>{nothing, nothing});
    EXPECT_EQ(distribution.Probability(0), 0.5f);
    EXPECT_EQ(distribution.Probability(1), 0.5f);
  }
}

TEST(PiecewiseConstant2D, SamplesFollowTheWeights) {
  constexpr int kWidth = 37, kHeight = 23, kSamples = 1000000;
  TestRandom random(3);
  std::vector<float> weights;
  double total = 0;
  for (int i = 0; i < kWidth * kHeight; ++i) {
    weights.push_back(i % 7 == 0 || i / kWidth == 4 ? 0 : std::pow(random.Float(), 8.0f));
    total += weights.back();
  }
  const PiecewiseConstant2D distribution(weights, kWidth, kHeight);
  std::vector<double> counts(weights.size(), 0.0), expected;
  for (int i = 0; i < kSamples; ++i) {
    float pdf;
    const Vec2f p = distribution.Sample(random.Float2(), &pdf);
    ASSERT_EQ(pdf, distribution.Pdf(p));
    ASSERT_GT(pdf, 0);
    ++counts[static_cast<int>(p.y * kHeight) * kWidth + static_cast<int>(p.x * kWidth)];
  }
  for (const float w : weights) expected.push_back(kSamples * w / total);
  EXPECT_GT(ChiSquareTest(counts, expected).p, 0.01);
  double integral = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      integral += distribution.Pdf({(x + 0.5f) / kWidth, (y + 0.5f) / kHeight});
    }
  }
  EXPECT_NEAR(integral / (kWidth * kHeight), 1, 1e-5);
}

}  // namespace
}  // namespace strata
