#pragma once

#include <cstdint>
#include <vector>

#include "common/report.h"
#include "coordinator/film.h"

// Estimates and their errors, as functions of a film alone (design, section 5).

namespace strata {

/// The error-carrying channels: R, G, B.
inline constexpr int kColours = 3;

/// ci95 is +- t sqrt(v / n), with v the mean of two halves: the pixel's own n stderr^2, and its
/// mean over the 8 pixels around it. Each has 7 degrees of freedom, so v has 7 / (1/4 + 1/32),
/// about 25 (Satterthwaite 1946), and t is the 97.5 % quantile of Student's distribution with as
/// many. All nine in equal parts would be steadier and fail where the variance changes from pixel
/// to pixel: docs/decisions.md.
inline constexpr double kIntervalDegrees = 25;
inline constexpr double kStudent25 = 2.059538552753294;
/// The same quantile with 7 degrees, for a pixel that has no neighbours.
inline constexpr double kStudent7 = 2.364624251592785;

/// A pixel is flagged when the skewness of its mean, as the 5x5 ring without the pixel shows it,
/// g / sqrt(n), is above this. docs/accuracy.md has coverage against it.
inline constexpr double kMostSkewness = 0.5;

/// stderr^2, the square of s_R / sqrt(R) over the replicate means, whose mean is `mean`.
double ErrorSquared(const PixelLayout& layout, const double* values, int channel, double mean);

/// One pixel's estimate. Zero throughout while it has no samples.
struct PixelEstimate {
  uint64_t samples = 0;  ///< Over all replicates.
  double mean[kColours] = {};
  double standard_error[kColours] = {};  ///< s_R / sqrt(R) of the replicate means.
  double ci95[kColours] = {};            ///< Half-width; infinite where none is claimed.
  double variance[kColours] = {};        ///< Per sample: m2 / (N - 1).
  uint32_t flags = 0;                    ///< kFlagSkew, kFlagNonFinite, kFlagNoInterval.
};

/// What the estimates of a rectangle are made of: its pixels and, for the neighbourhoods, a margin
/// around it, with zeros outside the crop. Copied from a film so that nothing is locked while
/// estimates are computed.
struct EstimateInput {
  static constexpr int kMargin = 2;  ///< The reach of the largest neighbourhood, the 5x5 ring.
  PixelRect wanted;
  bool claims_interval = true;  ///< Whether replicates are independent.
  /// For each pixel of the rectangle and its margin, row-major.
  std::vector<double> samples;  ///< Over all replicates.
  std::vector<uint8_t> nonfinite;
  /// The same for each colour.
  std::vector<double> mean[kColours], error_squared[kColours], m2[kColours], m3[kColours];
};

/// `sampler` drew the film's samples.
EstimateInput GatherEstimateInput(const Film& film, const PixelRect& wanted,
                                  SamplerKind sampler = SamplerKind::kSobol);

/// For each wanted pixel, row-major. Does not depend on how the crop is cut into rectangles.
std::vector<PixelEstimate> Estimate(const EstimateInput& input);

}  // namespace strata
