#pragma once

#include <cstddef>
#include <vector>

// Tests of hypotheses. A p-value is the probability, where the hypothesis is true, of what was
// seen or something further off; it is then uniform in [0, 1].

namespace strata {

/// Probability that Student's t with `degrees` > 0 degrees of freedom is at least as far from zero
/// as `t`.
double StudentTwoSidedP(double t, double degrees);

/// A sum of estimated variances of independent normal means, and how well it is known (Welch 1947,
/// "The generalization of Student's problem", Biometrika 34).
struct VarianceSum {
  double sum = 0, sum_of_squares = 0;

  void Add(double variance) {
    sum += variance;
    sum_of_squares += variance * variance;
  }
  void Add(const VarianceSum& other) {
    sum += other.sum;
    sum_of_squares += other.sum_of_squares;
  }
  /// Degrees of freedom of the sum when each term has `degrees`: between `degrees` (one term rules)
  /// and about `degrees` times their number (all alike). The better known form without the 2 falls
  /// short by a factor of degrees / (degrees + 2), because the squares are estimates too. For
  /// sum > 0.
  double Degrees(double degrees) const;
};

/// Kolmogorov's and Smirnov's test that independent values are uniform in [0, 1]: p-value of the
/// largest distance between their distribution function and the diagonal, on both sides. By
/// Stephens' approximation for finite numbers (1970, Journal of the Royal Statistical Society B
/// 32); below 0.001 it is up to a quarter too large for 20 values, and more so, on the safe side,
/// for fewer. 1 for no values.
double KolmogorovSmirnovP(std::vector<double> values);

/// Probability that the smallest of `tests` p-values is as small as `smallest` (Sidak 1967). Exact
/// for independent tests; too large, so on the safe side, for two-sided tests of correlated
/// normal means.
double SidakP(double smallest, size_t tests);

}  // namespace strata
