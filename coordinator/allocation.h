#pragma once

#include <cstdint>
#include <vector>

#include "coordinator/pixel_statistics.h"

// How many samples each pixel gets (design, section 5).
//
// A uniform pilot of n0 samples for each pixel comes first. From its snapshot pixel p gets
//   n_p = n0 + (N - n0) s_p / mean(s_q over q outside of p's 5x5),  s = sqrt(weight variance /
//   cost)
// in all, with N the wanted average, at most 8 N, rounded to multiples of 8. Neyman's allocation
// (1934) has s known; here weight times variance, and the cost, are pooled over the 5x5 ring around
// the pixel without the pixel. The product and not each factor: beside a lamp the variance of a
// bright pixel does not go with the weight of a dark one.
//
// Unbiased, exactly: the samples of p do not enter n_p in any way, and pixels are independent, so
// that given n_p the samples of p are distributed as if n_p had been fixed beforehand.
//  - s_p is from the ring, which leaves p out.
//  - s_q for q outside of p's 5x5 is from q's ring. Its pixels are at most 2 away from q, and thus
//    at least 1 away from p.
//  - The weight 1/max(luminance, 5 % of the image mean)^2 needs an image mean. Left to q, as the
//    mean without q's 5x5, it would have p in it. Hence n_p is made throughout, for s_p and for all
//    s_q, with one image mean, that without *p's* 5x5 (luminance_floor.h).
// Nothing is subtracted from a sum either (ring_pool.h), so the count stays to the last bit
// whatever the pixel's own statistics are.
//
// The price of leaving out the 5x5 is that the realised budget is a little above N where a few
// pixels have most of the noise. It is reported, never renormalised.

namespace strata {

/// No pixel gets more than this many times the average.
inline constexpr double kMostOfAverage = 8;

/// What an allocation makes small for the rays it spends.
enum class AllocationGoal {
  kRelativeError,  ///< Mean squared error over squared luminance; the cost of a sample is its rays.
  kSquaredError,   ///< Mean squared error (weight 1), samples of equal cost.
};

/// The samples a pixel gets before anything is known, over all replicates: max(32, spp / 4) rounded
/// up to a multiple of 8. It is `spp` itself, so that there is no second round, where this is not
/// less than `spp` and where a crop has fewer than 32 pixels in one direction: rings are then too
/// large a part of the image.
uint32_t PilotSamples(PlaneSize crop, uint32_t spp);

/// For each pixel the samples of each replicate it shall have in all, from the snapshot of the
/// pilot of PilotSamples. `spp` is the average N, over all replicates, a multiple of 8. The
/// variance of a pixel is the sum over its channels. Where no other pixel has any variance the
/// pixel gets 8 N, or N if its ring has none either. A sample costs at least one ray. A pixel with
/// samples that were not finite is treated as any other.
std::vector<uint32_t> AllocateByRing(const PixelStatistics& pilot, uint32_t spp,
                                     AllocationGoal goal = AllocationGoal::kRelativeError);

/// The same from each pixel's own statistics: the control that must fail the tests of bias, never
/// to be used for pictures. A pixel whose pilot happens to be dark looks free of noise and stays
/// dark.
std::vector<uint32_t> AllocateByOwnPixel(const PixelStatistics& pilot, uint32_t spp,
                                         AllocationGoal goal = AllocationGoal::kRelativeError);

}  // namespace strata
