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
// the next one has. All that is decided for pixel p, in every round, is decided from other pixels,
// to the last bit: from p's 5x5 ring without p and from figures of the image without p's 5x5.
// Planned from the pilot alone, counts thus leave the estimate exactly unbiased, as in
// allocation.h.
//
// Bound for later rounds. There p's ring had counts that depended on p. Hold the samples of all
// pixels but p fixed: then p's count N is a function of p's own samples alone, made of a few
// rounds, and changes with them only by that detour. For any count n, the mean of n samples is
// unbiased, so with n the usual count
//   bias = E[(mean_N - mean_n) 1{N != n}],   |bias| <= sqrt(P(N != n) E[(mean_N - mean_n)^2])
// by Cauchy and Schwarz: at most sqrt(2 P(N != n)) standard errors if the two means are as precise
// as planned. For independent samples N is a stopping time, the sum S_N of the deviations has mean
// 0 and variance sigma^2 E[N] (Wald 1944), and bias = Cov(S_N, 1/N), so that
//   |bias| / (sigma / sqrt(E[N])) <= E[N] sd(1/N),
// about the coefficient of variation of N when the samples of p alone are drawn anew. Both are zero
// after the pilot's plan. What they are later, and the far smaller bias there is, is measured by
// tests/farm/error_target_test.cpp.

namespace strata {

/// What a target asks for next.
struct TargetRound {
  /// For each pixel the samples of each replicate it shall have in all; at least what it has.
  std::vector<uint32_t> ends;
  uint64_t added = 0;          ///< Samples of the round, over all pixels and replicates. 0: no more
                               ///< rounds, since the target is met or the cap is reached.
  double added_deviation = 0;  ///< Standard error of `added` as an estimate of what is needed.
  double error = 0;            ///< As it stands; the target is met when it is not above it.
  double met_share = 0;        ///< Share of the judged pixels that meet the target as it stands;
                               ///< of an `--rmse`, 0 or 1.
  bool met = false;
};

/// The cap for every pixel, whatever is known.
TargetRound PlanCap(const PixelStatistics& now, uint32_t spp);

/// `--error`: t(50, 0.975) sqrt(v / n) of every channel is at most `error` times max(luminance, 5 %
/// of the image mean) for 99 % of the pixels, with v over the squared luminance pooled over the
/// pixel's ring. Pixels with samples that were not finite are not judged. The cap `spp` is for each
/// pixel, hence for the average too. The pixels that need most, one in two hundred, get as much as
/// the one after them. Requires error > 0 and `spp` a multiple of 8.
TargetRound PlanForRelativeError(const PixelStatistics& now, double error, uint32_t spp);

/// `--rmse`: sqrt of the mean of stderr^2 over all pixels and channels is at most `rmse`, in the
/// units of the picture, at the least cost in rays that is known: n_p = K sqrt(v_p / rays_p) from
/// the ring, and K, from a geometric grid with 32 steps to the octave, the least that makes the
/// mean over the image outside of p's 5x5 small enough. `spp` caps each pixel. Requires rmse > 0.
TargetRound PlanForRmse(const PixelStatistics& now, double rmse, uint32_t spp);

}  // namespace strata
