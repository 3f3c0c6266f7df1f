#include "common/statistics.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cmath>

namespace strata {

double StudentTwoSidedP(double t, double degrees) {
  // The normal distribution for all that is asked; the incomplete beta function loses its digits
  // beyond.
  constexpr double kManyDegrees = 1e6;
  const double n = std::min(degrees, kManyDegrees);
  return boost::math::ibeta(0.5 * n, 0.5, n / (n + t * t));
}

double VarianceSum::Degrees(double degrees) const {
  return (degrees + 2) * (sum * sum / sum_of_squares) - 2;
}

double KolmogorovSmirnovP(std::vector<double> values) {
  if (values.empty()) return 1;
  std::sort(values.begin(), values.end());
  const auto n = static_cast<double>(values.size());
  double distance = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    const auto below = static_cast<double>(i);
    distance = std::max({distance, values[i] - below / n, (below + 1) / n - values[i]});
  }
  const double x = (std::sqrt(n) + 0.12 + 0.11 / std::sqrt(n)) * distance;
  // The series of Kolmogorov's distribution alternates around 1/2 where x is small.
  constexpr double kCertain = 0.3;
  if (x < kCertain) return 1;
  double p = 0;
  for (int k = 1; k <= 20; ++k) p += (k % 2 == 1 ? 2 : -2) * std::exp(-2.0 * k * k * x * x);
  return std::clamp(p, 0.0, 1.0);
}

double SidakP(double smallest, size_t tests) {
  return -std::expm1(static_cast<double>(tests) * std::log1p(-smallest));
}

}  // namespace strata
