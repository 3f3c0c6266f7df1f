#include "worker/sampling/roulette.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"
#include "worker/math/vec.h"

namespace strata {
namespace {

/// F of mean 2 and variance 3: exponential times sqrt(3), shifted.
double DrawEstimate(TestRandom& random) {
  return 2 + std::sqrt(3.0) * (-std::log1p(-random.Double()) - 1);
}
constexpr double kMean = 2, kVariance = 3;

struct Moments2 {
  MeanWithError mean, square_off;
};

Moments2 Play(const Roulette<double>& roulette, uint64_t seed) {
  TestRandom random(seed);
  Moments2 result;
  for (int i = 0; i < 1000000; ++i) {
    const double value =
        roulette.Ends(random.Float()) ? roulette.c : roulette.Survivor(DrawEstimate(random));
    result.mean.Add(value);
    result.square_off.Add((value - kMean) * (value - kMean));
  }
  return result;
}

TEST(Roulette, KeepsTheMeanForAnyCAndHasTheVarianceOfTheFormula) {
  uint64_t seed = 1;
  for (const float q : {0.0f, 0.25f, 0.5f, 0.875f}) {
    for (const double c : {0.0, 1.0, kMean, -3.0, 10.0}) {
      const Moments2 played = Play({q, c}, ++seed);
      const double expected = RouletteVariance(kMean, kVariance, q, c);
      EXPECT_NEAR(played.mean.mean(), kMean, 4.5 * played.mean.error()) << q << " " << c;
      EXPECT_NEAR(played.square_off.mean(), expected, 4.5 * played.square_off.error())
          << q << " " << c;
      // The controls: a mean and a variance that are 10 % off.
      EXPECT_GT(std::abs(1.1 * kMean - played.mean.mean()), 4.5 * played.mean.error());
      EXPECT_GT(std::abs(1.1 * expected - played.square_off.mean()),
                4.5 * played.square_off.error());
    }
  }
}

TEST(Roulette, IsTheUsualOneWithCOfZero) {
  const Roulette<double> roulette = {0.75f};
  EXPECT_EQ(roulette.c, 0);
  EXPECT_EQ(roulette.Survivor(3.0), 12.0);
  const Roulette<Rgb> colour = {0.5f, {0, 1, 2}};
  EXPECT_EQ(colour.Survivor({1, 1, 1}).r, 2);
  EXPECT_EQ(colour.Survivor({1, 1, 1}).g, 1);
  EXPECT_EQ(colour.Survivor({1, 1, 1}).b, 0);
}

TEST(Roulette, VarianceIsLeastWhereCIsTheMeanAndNeverBelowThatOfF) {
  for (const double q : {0.1, 0.5, 0.9}) {
    EXPECT_DOUBLE_EQ(RouletteVariance(kMean, kVariance, q, kMean), kVariance / (1 - q));
    for (const double c : {-5.0, 0.0, 1.9, 2.1, 7.0}) {
      EXPECT_GT(RouletteVariance(kMean, kVariance, q, c),
                RouletteVariance(kMean, kVariance, q, kMean));
    }
  }
  EXPECT_EQ(RouletteVariance(kMean, kVariance, 0, 7), kVariance);
}

TEST(SurvivalProbability, IsTheSameForOnePathAndForEight) {
  TestRandom random(6);
  for (int i = 0; i < 1000; ++i) {
    const float throughput = random.Float(), sure = throughput + random.Float() + 0x1p-20f;
    const float survival = SurvivalProbability(throughput, sure);
    EXPECT_GE(survival, kMinSurvival);
    EXPECT_LE(survival, 1);
    EXPECT_EQ(SurvivalProbability(SameFloat(throughput), SameFloat(sure))[i % kLanes], survival);
  }
}

}  // namespace
}  // namespace strata
