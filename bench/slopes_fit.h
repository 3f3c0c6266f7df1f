#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace strata {

/// y ~ x^slope.
struct PowerLaw {
  double slope = 0;
  double error = 0;  ///< Standard error of the slope, from the scatter around the line.
};

/// Least squares of log y over log x. Takes at least 3 positive points whose x are not all equal.
inline PowerLaw FitPowerLaw(const std::vector<double>& x, const std::vector<double>& y) {
  const double n = static_cast<double>(x.size());
  double mean_x = 0, mean_y = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    mean_x += std::log(x[i]) / n;
    mean_y += std::log(y[i]) / n;
  }
  double xx = 0, xy = 0, yy = 0;
  for (size_t i = 0; i < x.size(); ++i) {
    const double dx = std::log(x[i]) - mean_x, dy = std::log(y[i]) - mean_y;
    xx += dx * dx;
    xy += dx * dy;
    yy += dy * dy;
  }
  const double slope = xy / xx;
  const double residual = yy - slope * xy;
  return {slope, std::sqrt(std::fmax(residual, 0) / (n - 2) / xx)};
}

}  // namespace strata
