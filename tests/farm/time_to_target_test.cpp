// When a target is reached, and how well that is known.

#include "coordinator/time_to_target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <random>

namespace strata {
namespace {

TEST(TimeToTargetTest, IsSamplesOverRate) {
  const TimeToTarget time = PredictTimeToTarget({5000, 0}, {2, {90, 110, 100}});
  EXPECT_EQ(time.samples, 5000);
  EXPECT_DOUBLE_EQ(time.seconds, 50);
  EXPECT_LT(time.low_seconds, 50);
  EXPECT_GT(time.high_seconds, 50);
  EXPECT_NEAR(time.low_seconds * time.high_seconds, 2500, 1e-9);
}

TEST(TimeToTargetTest, SaysWhatItDoesNotKnow) {
  EXPECT_LT(PredictTimeToTarget({5000, 0}, {1, {}}).seconds, 0);
  EXPECT_LT(PredictTimeToTarget({5000, 0}, {1, {0, 0}}).seconds, 0);
  const TimeToTarget once = PredictTimeToTarget({5000, 0}, {1, {100}});
  EXPECT_EQ(once.seconds, 50);
  EXPECT_LT(once.high_seconds, 0);
  const TimeToTarget done = PredictTimeToTarget({0, 0}, {1, {}});
  EXPECT_EQ(done.seconds, 0);
  EXPECT_EQ(done.high_seconds, 0);
}

TEST(TimeToTargetTest, IsSurerTheMoreIsKnown) {
  const auto spread = [](const RemainingSamples& remaining, const MeasuredRates& rates) {
    const TimeToTarget time = PredictTimeToTarget(remaining, rates);
    return time.high_seconds / time.low_seconds;
  };
  const MeasuredRates few{1, {90, 110}}, more{1, {90, 110, 90, 110, 90, 110}};
  EXPECT_GT(spread({5000, 0}, few), spread({5000, 0}, more));
  EXPECT_GT(spread({5000, 500}, more), spread({5000, 50}, more));
  EXPECT_GT(spread({100, 0}, more), spread({5000, 0}, more)) << "long times even out";
}

/// The share of intervals that hold the true time. Rates and samples vary by 20 % and `deviation`.
double Coverage(int spans, double deviation, double claimed_deviation) {
  constexpr int kTrials = 20000;
  constexpr double kSamples = 4000;
  std::mt19937_64 random(31);
  std::normal_distribution<double> normal;
  const auto rate = [&] { return std::max(100 * (1 + 0.2 * normal(random)), 1.0); };
  int held = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    MeasuredRates rates{1, {}};
    for (int k = 0; k < spans; ++k) rates.per_second.push_back(rate());
    const double estimate = kSamples * (1 + deviation * normal(random));
    const TimeToTarget time = PredictTimeToTarget({estimate, claimed_deviation * kSamples}, rates);
    double left = kSamples, seconds = 0;
    for (double r; left > 0; left -= r) {
      r = rate();
      seconds += std::min(left / r, 1.0);
    }
    held += time.low_seconds <= seconds && seconds <= time.high_seconds;
  }
  return held / double{kTrials};
}

// 20000 trials: a standard error of 0.002.
TEST(TimeToTargetTest, HoldsInNineOfTenCases) {
  for (const int spans : {3, 5, 20}) {
    for (const double deviation : {0.0, 0.05, 0.2}) {
      const double coverage = Coverage(spans, deviation, deviation);
      std::printf("%d spans, samples known to %.2f: %.3f\n", spans, deviation, coverage);
      EXPECT_GT(coverage, 0.87);
      EXPECT_LT(coverage, 0.97);
    }
  }
  EXPECT_LT(Coverage(20, 0.2, 0), 0.6) << "the control: samples believed to be known";
}

}  // namespace
}  // namespace strata
