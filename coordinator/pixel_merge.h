#pragma once

#include "common/pixel_layout.h"

namespace strata {

/// The mean over all samples of a pixel: replicates have equal counts.
inline double PooledMean(const PixelLayout& layout, const double* values, int channel) {
  double sum = 0;
  for (int r = 0; r < kReplicates; ++r) sum += values[layout.Mean(r, channel)];
  return sum / kReplicates;
}

/// Adds a pixel's values `b`, of `samples_b` > 0 samples in each replicate, to `a` of `samples_a`:
/// replicate and plain means, then m2 and m3 about the pooled means. Chan, Golub and LeVeque 1979,
/// "Updating formulae and a pairwise algorithm for computing sample variances"; Pebay 2008 (third
/// moment). Not symmetric in its bits: the order of calls counts.
void MergePixel(const PixelLayout& layout, double samples_a, double* a, double samples_b,
                const double* b);

}  // namespace strata
