// p-values against closed forms, and their frequencies against their level.

#include "common/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace strata {
namespace {

TEST(StudentTest, FollowsTheClosedForms) {
  for (const double t : {0.0, 0.3, 1.0, 4.0, 60.0}) {
    const double cauchy = 1 - 2 * std::atan(t) / std::numbers::pi;
    EXPECT_NEAR(StudentTwoSidedP(t, 1), cauchy, 1e-13);
    EXPECT_NEAR(StudentTwoSidedP(-t, 2), 1 - t / std::sqrt(2 + t * t), 1e-13);
  }
  for (const double t : {0.0, 1.0, 3.0, 6.0}) {
    const double normal = std::erfc(t / std::numbers::sqrt2);
    EXPECT_NEAR(StudentTwoSidedP(t, 1e12) / normal, 1, 1e-3) << t;
  }
}

TEST(VarianceSumTest, DegreesAreThoseOfOneTermOrOfAll) {
  VarianceSum one;
  one.Add(0.3);
  one.Add(0);
  EXPECT_DOUBLE_EQ(one.Degrees(7), 7);

  // 1000 variances, each estimated with 7 degrees: 7000, to within 6 standard deviations. Taking
  // the estimates for the variances themselves, the control, gives 7 / 9 of that.
  std::mt19937_64 random(11);
  std::chi_squared_distribution<double> chi2(7);
  VarianceSum many;
  for (int i = 0; i < 1000; ++i) many.Add(chi2(random));
  EXPECT_NEAR(many.Degrees(7), 7000, 900);
  EXPECT_LT(7 * many.sum * many.sum / many.sum_of_squares, 7000 - 900);
}

/// Probability that the distribution function of n uniform values exceeds the diagonal by more than
/// d somewhere (Birnbaum and Tingey 1951). Twice that is the two-sided probability in the tail.
double OneSidedP(int n, double d) {
  double sum = 0;
  for (int j = 0; j <= static_cast<int>(n * (1 - d)); ++j) {
    const double share = static_cast<double>(j) / n;
    sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(j + 1.0) - std::lgamma(n - j + 1.0) +
                    (j - 1) * std::log(d + share) + (n - j) * std::log(1 - d - share));
  }
  return d * sum;
}

/// n values whose distance from uniformity is d >= 1 / n: evenly spread over [0, 1 - d + 1 / n).
std::vector<double> AtDistance(int n, double d) {
  std::vector<double> values;
  for (int i = 0; i < n; ++i) values.push_back((1 - d) * i / (n - 1));
  return values;
}

TEST(KolmogorovSmirnovTest, FollowsTheExactDistributionInTheTail) {
  for (const int n : {20, 144, 1000}) {
    for (const double x : {1.36, 1.63, 1.95, 2.2}) {
      const double d = x / std::sqrt(n);
      const double ratio = KolmogorovSmirnovP(AtDistance(n, d)) / (2 * OneSidedP(n, d));
      EXPECT_GT(ratio, 0.95) << n << " values, distance " << d;
      EXPECT_LT(ratio, n == 20 ? 1.25 : 1.05) << n << " values, distance " << d;
    }
  }
}

TEST(KolmogorovSmirnovTest, FewValuesErrToLargeP) {
  EXPECT_EQ(KolmogorovSmirnovP({}), 1);
  for (const double d : {0.98, 0.999, 0.99999}) {
    EXPECT_GT(KolmogorovSmirnovP({1 - d}), 2 * (1 - d)) << d;  // Exact for one value.
    EXPECT_GT(KolmogorovSmirnovP(AtDistance(5, d)), 2 * OneSidedP(5, d)) << d;
  }
}

/// Share of 4000 sets of n values that are called not uniform at level 0.05.
double ShareRejected(int n, double power) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> uniform;
  int rejected = 0;
  for (int set = 0; set < 4000; ++set) {
    std::vector<double> values;
    for (int i = 0; i < n; ++i) values.push_back(std::pow(uniform(random), power));
    rejected += KolmogorovSmirnovP(values) < 0.05;
  }
  return rejected / 4000.0;
}

TEST(KolmogorovSmirnovTest, UniformValuesAreRejectedAsOftenAsTheLevelSays) {
  // Four standard deviations of a share of 4000.
  for (const int n : {5, 24, 144}) EXPECT_NEAR(ShareRejected(n, 1), 0.05, 0.014) << n;
  EXPECT_GT(ShareRejected(144, 1.3), 0.5) << "control: u^1.3 is not uniform";
}

TEST(SidakTest, FollowsTheClosedForm) {
  EXPECT_EQ(SidakP(0, 5), 0);
  EXPECT_EQ(SidakP(1, 5), 1);
  EXPECT_EQ(SidakP(0.5, 0), 0) << "no tests";
  EXPECT_DOUBLE_EQ(SidakP(0.1, 2), 0.19);
  EXPECT_NEAR(SidakP(1e-20, 1000) / 1e-17, 1, 1e-12) << "no digits are lost";
}

}  // namespace
}  // namespace strata
