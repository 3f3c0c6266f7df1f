#include "worker/sampling/mis.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <limits>
#include <vector>

#include "common/moments.h"
#include "tests/statistics/random.h"
#include "worker/sampling/inversion.h"
#include "worker/sampling/warp.h"

// The integral of x^2 (1 - x) + 1/10 over [0, 1] by three techniques: uniform, 4 x^3, and a line
// that falls to nothing. Each way to combine them is unbiased, and its variance is what quadrature
// of Veach's formulas gives.

namespace strata {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kTechniques = 3;
constexpr double kIntegral = 1.0 / 12 + 0.1;

double Integrand(double x) { return x * x * (1 - x) + 0.1; }

using Shares = std::array<double, kTechniques>;

double Pdf(int technique, double x) {
  const auto point = static_cast<float>(x);
  switch (technique) {
    case 0:
      return 1;
    case 1:
      return PowerPdf(point, 3);
    default:
      return LinearPdf(point, 2, 0);
  }
}
double Sample(int technique, float u) {
  switch (technique) {
    case 0:
      return u;
    case 1:
      return SamplePower(u, 3);
    default:
      return SampleLinear(u, 2, 0);
  }
}
/// n_k p_k(x), or c_k p_k(x).
Shares SharesAt(double x, const Shares& factors) {
  Shares shares;
  for (int k = 0; k < kTechniques; ++k) shares[k] = factors[k] * Pdf(k, x);
  return shares;
}

double Quadrature(const std::function<double(double)>& f) {
  constexpr int kSteps = 4000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) sum += f((i + 0.5) / kSteps);
  return sum / kSteps;
}

/// The integral over x of p_k (w_k f / p_k)^power / factor_k^(power - 1), where w f over the share
/// is MisTerm.
double TermMoment(int k, int power, const Shares& factors, double beta) {
  return Quadrature([&](double x) {
    const double term = MisTerm(Integrand(x), SharesAt(x, factors), k, beta);
    return factors[k] * Pdf(k, x) * std::pow(term, power);
  });
}

/// Of the sum over n_k samples of each technique: independent terms, each with its own mean.
double MultiSampleVariance(const Shares& counts, double beta) {
  double variance = 0;
  for (int k = 0; k < kTechniques; ++k) {
    const double mean = TermMoment(k, 1, counts, beta) / counts[k];
    variance += TermMoment(k, 2, counts, beta) - counts[k] * mean * mean;
  }
  return variance;
}
/// Of one sample of one technique.
double OneSampleVariance(const Shares& probabilities, double beta) {
  double second = 0;
  for (int k = 0; k < kTechniques; ++k) second += TermMoment(k, 2, probabilities, beta);
  return second - kIntegral * kIntegral;
}

double MultiSampleEstimate(const Shares& counts, double beta, TestRandom& random) {
  double sum = 0;
  for (int k = 0; k < kTechniques; ++k) {
    for (int i = 0; i < counts[k]; ++i) {
      const double x = Sample(k, random.Float());
      sum += MisTerm(Integrand(x), SharesAt(x, counts), k, beta);
    }
  }
  return sum;
}
double OneSampleEstimate(const Shares& probabilities, double beta, TestRandom& random) {
  const double u = random.Double();
  const int k = u < probabilities[0] ? 0 : u < probabilities[0] + probabilities[1] ? 1 : 2;
  const double x = Sample(k, random.Float());
  return MisTerm(Integrand(x), SharesAt(x, probabilities), k, beta);
}

/// Mean and variance over 100000 estimates, each within four of its standard errors. The variance's
/// comes from its spread over 200 batches.
void ExpectMoments(const std::string& what, const std::function<double()>& estimate,
                   double variance) {
  constexpr int kBatches = 200, kBatch = 500;
  Moments all, variances;
  for (int b = 0; b < kBatches; ++b) {
    Moments batch;
    for (int i = 0; i < kBatch; ++i) batch.Add(estimate());
    variances.Add(batch.m2 / (kBatch - 1));
    all.Merge(batch);
  }
  const double error = std::sqrt(variance / static_cast<double>(all.count));
  EXPECT_NEAR(all.mean, kIntegral, 4 * error) << what;
  const double variance_error = std::sqrt(variances.m2 / (kBatches - 1) / kBatches);
  EXPECT_NEAR(variances.mean, variance, 4 * variance_error) << what;
  std::printf("%-24s mean %.6f (%.6f +- %.6f), variance %.4e (%.4e +- %.1e)\n", what.c_str(),
              all.mean, kIntegral, error, variances.mean, variance, variance_error);
  // Control: a bias of 5 % would have been seen.
  EXPECT_GT(std::fabs(1.05 * all.mean - kIntegral), 4 * error) << what;
}

constexpr Shares kCounts = {2, 1, 3};
constexpr Shares kProbabilities = {0.25, 0.25, 0.5};
const std::vector<std::pair<double, const char*>> kBetas = {
    {0, "average"}, {1, "balance"}, {2, "power 2"}, {5, "power 5"}, {kInfinity, "maximum"}};

TEST(Mis, EveryHeuristicIsUnbiasedAndOfTheVarianceTheoryGives) {
  TestRandom random(1);
  for (const auto& [beta, name] : kBetas) {
    // The plain average divides by the vanishing end of the line's density: its variance is
    // infinite there, as Veach warns.
    if (beta == 0) continue;
    ExpectMoments(
        std::string(name) + ", multi-sample",
        [&, b = beta] { return MultiSampleEstimate(kCounts, b, random); },
        MultiSampleVariance(kCounts, beta));
    ExpectMoments(
        std::string(name) + ", one-sample",
        [&, b = beta] { return OneSampleEstimate(kProbabilities, b, random); },
        OneSampleVariance(kProbabilities, beta));
  }
}

TEST(Mis, InTheOneSampleModelTheBalanceHeuristicIsBest) {
  // Veach 1997, theorem 9.4; and its estimate is f over the mixture's density.
  const double best = OneSampleVariance(kProbabilities, kBalance);
  for (const double beta : {0.5, 1.5, 2.0, 5.0, kInfinity}) {
    EXPECT_LT(best, OneSampleVariance(kProbabilities, beta)) << beta;
  }
  for (const double x : {0.01, 0.5, 0.9}) {
    const Shares shares = SharesAt(x, kProbabilities);
    EXPECT_NEAR(MisTerm(Integrand(x), shares, 1, kBalance),
                Integrand(x) / (shares[0] + shares[1] + shares[2]), 1e-12);
  }
}

TEST(Mis, NoHeuristicBeatsBalanceByMoreThanVeachsBound) {
  // Theorem 9.2: V(balance) - V(any) <= (1 / min n_k - 1 / sum n_k) mu^2.
  const double bound = (1.0 - 1.0 / 6) * kIntegral * kIntegral;
  const double balance = MultiSampleVariance(kCounts, kBalance);
  for (const double beta : {2.0, 5.0, kInfinity}) {
    EXPECT_LE(balance - MultiSampleVariance(kCounts, beta), bound) << beta;
  }
}

TEST(Mis, WeightsSumToOneHoweverUnequalTheShares) {
  const std::vector<Shares> cases = {
      {1, 2, 3}, {1e-300, 1, 1e300}, {0, 0, 5}, {0, 1e-20, 1e20}, {kInfinity, 1, kInfinity}};
  for (const auto& [beta, name] : kBetas) {
    for (const Shares& shares : cases) {
      double sum = 0;
      for (int k = 0; k < kTechniques; ++k) {
        const double weight = MisWeight(shares, k, beta);
        EXPECT_GE(weight, 0);
        sum += weight;
      }
      EXPECT_NEAR(sum, 1, 1e-12) << name << ": " << shares[0] << " " << shares[1] << " "
                                 << shares[2];
    }
  }
  EXPECT_EQ(MisWeight(Shares{0, 0, 0}, 1, 2), 0);
}

TEST(Mis, TheRenderersHeuristicsAreTheCaseOfTwo) {
  for (const float a : {1e-30f, 0.3f, 4.0f}) {
    for (const float b : {0.0f, 0.1f, 20.0f}) {
      const std::array<double, 2> shares = {a, b};
      EXPECT_NEAR(BalanceHeuristic(a, b), MisWeight(shares, 0, kBalance), 1e-6);
      EXPECT_NEAR(PowerHeuristic(a, b), MisWeight(shares, 0, kPower), 1e-6);
    }
  }
}

TEST(MisControl, WeightsThatIgnoreATechniqueAreBiased) {
  // The weights of two techniques, with samples of three: what they sum to is not 1.
  TestRandom random(2);
  Moments estimates;
  for (int i = 0; i < 200000; ++i) {
    double sum = 0;
    for (int k = 0; k < kTechniques; ++k) {
      const double x = Sample(k, random.Float());
      const Shares shares = SharesAt(x, {1, 1, 1});
      const std::array<double, 2> two = {shares[0], shares[1]};
      sum +=
          k < 2 ? MisTerm(Integrand(x), two, k, kPower) : MisTerm(Integrand(x), shares, k, kPower);
    }
    estimates.Add(sum);
  }
  const double n = static_cast<double>(estimates.count);
  EXPECT_GT(std::fabs(estimates.mean - kIntegral), 10 * std::sqrt(estimates.m2 / n / n));
}

}  // namespace
}  // namespace strata
