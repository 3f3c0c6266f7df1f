#include "coordinator/confidence_sequence.h"

#include <cmath>
#include <numbers>

#include "coordinator/estimate.h"

namespace strata {
namespace {

constexpr double kMissed = 0.05;

/// The probability that a normal mean is ever `c` standard errors off while its samples grow by a
/// factor with the logarithm `log_growth`.
double EverOff(double c, double log_growth) {
  const double density = std::exp(-0.5 * c * c) * std::numbers::inv_sqrtpi / std::numbers::sqrt2;
  return density * ((c - 1 / c) * log_growth + 4 / c);
}

/// The quantile of Student's distribution at the level of the normal quantile z: its expansion in
/// 1 / degrees (Abramowitz and Stegun 26.7.5), good to 1e-3 for z < 4.
double StudentQuantile(double z) {
  constexpr double n = kIntervalDegrees;
  const double z2 = z * z;
  return z + z * (z2 + 1) / (4 * n) + z * ((5 * z2 + 16) * z2 + 3) / (96 * n * n) +
         z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / (384 * n * n * n);
}

}  // namespace

double AnytimeFactor(double first, double planned) {
  if (!(planned > first)) return kStudent25;
  const double log_growth = std::log(planned / first);
  double low = 2, high = 10;  // EverOff falls with c in between.
  while (high - low > 1e-6) {
    const double middle = 0.5 * (low + high);
    (EverOff(middle, log_growth) > kMissed ? low : high) = middle;
  }
  return StudentQuantile(high);
}

}  // namespace strata
