#pragma once

#include <cstdint>
#include <vector>

#include "common/report.h"
#include "coordinator/film.h"

// Estimates and their errors, as functions of a film alone (design, section 5).

namespace strata {

/// The error-carrying channels: R, G, B.
inline constexpr int kColours = 3;

/// t(50, 0.975), the 97.5 % quantile of Student's distribution with 50 degrees of freedom: ci95
/// pools the variance of 3x3 pixels with 7 degrees each, which are worth about 50.
inline constexpr double kStudent50 = 2.008559112100761;

/// stderr^2, the square of s_R / sqrt(R) over the replicate means, whose mean is `mean`.
double ErrorSquared(const PixelLayout& layout, const double* values, int channel, double mean);

/// One pixel's estimate. Zero throughout while it has no samples.
struct PixelEstimate {
  uint64_t samples = 0;  ///< Over all replicates.
  double mean[kColours] = {};
  double standard_error[kColours] = {};  ///< s_R / sqrt(R) of the replicate means.
  double ci95[kColours] = {};            ///< Half-width; infinite where a sample was not finite.
  double variance[kColours] = {};        ///< Per sample: m2 / (N - 1).
  uint32_t flags = 0;                    ///< kFlagSkew, kFlagNonFinite.
};

/// What the estimates of a rectangle are made of: its pixels and, for the neighbourhoods, a margin
/// around it, with zeros outside the crop. Copied from a film so that nothing is locked while
/// estimates are computed.
struct EstimateInput {
  static constexpr int kMargin = 2;  ///< The reach of the largest neighbourhood, the 5x5 ring.
  PixelRect wanted;
  /// For each pixel of the rectangle and its margin, row-major.
  std::vector<double> samples;  ///< Over all replicates.
  std::vector<uint8_t> nonfinite;
  /// The same for each colour.
  std::vector<double> mean[kColours], error_squared[kColours], m2[kColours], m3[kColours];
};

EstimateInput GatherEstimateInput(const Film& film, const PixelRect& wanted);

/// For each wanted pixel, row-major. Does not depend on how the crop is cut into rectangles.
std::vector<PixelEstimate> Estimate(const EstimateInput& input);

}  // namespace strata
