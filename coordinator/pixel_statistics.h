#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "coordinator/estimate.h"
#include "coordinator/film.h"
#include "coordinator/ring_pool.h"

namespace strata {

/// Relative errors are measured against the luminance, but at least this share of the image's mean.
inline constexpr double kLeastShareOfMean = 0.05;

/// Rec.709 luminance.
inline double Luminance(const double rgb[kColours]) {
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// What decides the samples of the next round: a snapshot of all pixels of a crop, row-major. Taken
/// when a round is wholly merged; every pixel has samples. All numbers are finite, since a sample
/// that is not enters as zero.
struct PixelStatistics {
  PlaneSize size;
  std::vector<uint32_t> samples;   ///< Of each replicate, at least 1.
  Plane luminance;                 ///< Of the estimate.
  Plane variance[kColours];        ///< n stderr^2 with n over all replicates.
  Plane rays;                      ///< For each sample.
  std::vector<uint8_t> nonfinite;  ///< Whether the pixel had a sample that was not finite.
};

/// Requires samples in every pixel of the film. Uses all cores, as a 4K film is 2 GB.
PixelStatistics GatherPixelStatistics(const Film& film);

}  // namespace strata
