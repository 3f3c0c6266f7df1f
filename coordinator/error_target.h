#pragma once

#include <cstdint>
#include <vector>

#include "coordinator/pixel_statistics.h"

// What must still be rendered to reach a stated error (design, section 5).
//
// A crop of at most 5x5 pixels has no others to be planned by: it gets the cap, and is not met.
//
// Pure functions of a snapshot. A uniform pilot (PilotSamples) comes first, for `--error` and
// `--rmse` with `spp` as the cap; each later call, once the round it asked for is merged, says what
// the next one has, and the job ends when it has nothing. What is decided for pixel p, in every
// round and whether there is one, is decided from other pixels, to the last bit: from p's 5x5 ring
// without p and from the image without p's 5x5. Whether the target is met, which is said of the
// whole image, decides nothing. Planned from the pilot alone, counts thus leave the estimate
// exactly unbiased, as in allocation.h; later rounds do nearly: docs/accuracy.md, "Targets", has
// the bound, its proof, and what was measured.
//
// Not so with `uniform` allocation: its one count for all follows TargetRound::error, in which each
// pixel has its share.

namespace strata {

/// What a target asks for next.
struct TargetRound {
  /// For each pixel the samples of each replicate it shall have in all; at least what it has.
  std::vector<uint32_t> ends;
  uint64_t added = 0;           ///< Samples of the round, over all pixels and replicates. 0: the
                                ///< end, since the target is met or the cap is reached.
  double added_deviation = 0;   ///< Standard error of `added` as an estimate of what is needed.
  double error = 0;             ///< As it stands; the target is met when it is not above it.
  double square_deviation = 0;  ///< Relative standard error of the square of `error`.
  double met_share = 0;         ///< Share of the judged pixels that meet the target as it stands;
                                ///< of an `--rmse`, 0 or 1.
  bool met = false;
};

/// The cap for every pixel, whatever is known.
TargetRound PlanCap(const PixelStatistics& now, uint32_t spp);

/// `--error`: t(25, 0.975) sqrt(v / n) of every channel is at most `error` times max(luminance, 5 %
/// of the image mean) for 99 % of the pixels, with v over the squared luminance pooled over that
/// half of the pixel's ring where it is greatest (HighestHalfMeans). For each pixel its own 5x5
/// counts among those that miss, so that more than 99 % are asked for in crops of a few thousand
/// pixels; if that leaves room, the pixels that need most, one in two hundred, get as much as the
/// one after them. A pixel whose ring shows no noise gets no samples, and is judged by its own;
/// where there is none either, it counts as meeting the target. Skew plays no part: pixels that are
/// flagged for it are judged like others, by a variance that may have missed rare bright samples.
/// Pixels with samples that were not finite are not judged. The cap `spp` is for each pixel, hence
/// for the average too. Requires error > 0 and `spp` a multiple of 8.
TargetRound PlanForRelativeError(const PixelStatistics& now, double error, uint32_t spp);

/// `--rmse`: sqrt of the mean of stderr^2 over all pixels and channels is at most `rmse`, in the
/// units of the picture, at the least cost in rays that is known: n_p = K sqrt(v_p / rays_p) from
/// the ring, and K, from a geometric grid with 32 steps to the octave, the least that makes the
/// mean small enough in which the pixels of p's 5x5 have p's count and the variance of that half of
/// p's ring where it is greatest. A pixel for which that mean is small enough as it stands gets
/// none. `spp` caps each pixel. Requires rmse > 0.
TargetRound PlanForRmse(const PixelStatistics& now, double rmse, uint32_t spp);

}  // namespace strata
