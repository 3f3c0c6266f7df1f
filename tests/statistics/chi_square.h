#pragma once

#include <algorithm>
#include <boost/math/distributions/non_central_chi_squared.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <numeric>
#include <vector>

namespace strata {

struct ChiSquareResult {
  double statistic = 0;
  int degrees = 0;
  double p = 1;  ///< Probability of a statistic at least as large if the expectation is true.
};

/// Upper tail of the chi-square distribution.
inline double ChiSquareTail(double statistic, double degrees) {
  return boost::math::gamma_q(0.5 * degrees, 0.5 * std::max(statistic, 0.0));
}

/// Pearson's test of counts against their expectations, whose sums agree. Bins are taken in the
/// order of their expectation and pooled until 5 are expected; what is left joins the last pool.
/// A hit where next to nothing is expected fails it at once.
inline ChiSquareResult ChiSquareTest(const std::vector<double>& observed,
                                     const std::vector<double>& expected) {
  std::vector<size_t> order(expected.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](size_t a, size_t b) { return expected[a] < expected[b]; });
  struct Pool {
    double observed = 0, expected = 0;
  };
  std::vector<Pool> pools;
  Pool open;
  for (const size_t i : order) {
    if (expected[i] < 1e-9 && observed[i] > 0) return {HUGE_VAL, 1, 0};
    open.observed += observed[i];
    open.expected += expected[i];
    if (open.expected >= 5) {
      pools.push_back(open);
      open = {};
    }
  }
  if (!pools.empty()) {
    pools.back().observed += open.observed;
    pools.back().expected += open.expected;
  }
  ChiSquareResult result;
  result.degrees = static_cast<int>(pools.size()) - 1;
  if (result.degrees < 1) return result;
  for (const Pool& pool : pools) {
    const double off = pool.observed - pool.expected;
    result.statistic += off * off / pool.expected;
  }
  result.p = ChiSquareTail(result.statistic, result.degrees);
  return result;
}

/// How far a statistic must be shifted by a wrong expectation (samples times the mean square of its
/// relative error: Pearson's noncentrality) so that p falls below `level` but for one run in ten
/// thousand.
inline double NoncentralityFound(int degrees, double level) {
  constexpr double kMissed = 1e-4;
  const double critical = 2 * boost::math::gamma_q_inv(0.5 * degrees, level);
  return boost::math::non_central_chi_squared::find_non_centrality(degrees, critical, kMissed);
}

/// The level of each of `tests` independent tests that makes all of them together one of level
/// `alpha` (Sidak 1967).
inline double SidakLevel(double alpha, int tests) {
  return -std::expm1(std::log1p(-alpha) / tests);
}

/// Kolmogorov-Smirnov: the probability of a distance from the uniform distribution at least as
/// large as that of `values`, all in [0, 1] (asymptotic, with Stephens' correction).
inline double KolmogorovSmirnovUniform(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const double n = static_cast<double>(values.size());
  double distance = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    distance = std::max({distance, values[i] - static_cast<double>(i) / n,
                         static_cast<double>(i + 1) / n - values[i]});
  }
  const double lambda = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * distance;
  double sum = 0;
  for (int k = 1; k <= 100; ++k) {
    sum += (k % 2 ? 2 : -2) * std::exp(-2.0 * k * k * lambda * lambda);
  }
  return lambda < 0.2 ? 1 : std::clamp(sum, 0.0, 1.0);
}

/// Running mean and its standard error for independent values.
class MeanWithError {
 public:
  void Add(double value) {
    ++count_;
    const double off = value - mean_;
    mean_ += off / static_cast<double>(count_);
    squares_ += off * (value - mean_);
  }
  double mean() const { return mean_; }
  double error() const {
    return std::sqrt(squares_ / (static_cast<double>(count_) * static_cast<double>(count_ - 1)));
  }

 private:
  int64_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

}  // namespace strata
