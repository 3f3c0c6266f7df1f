#pragma once

#include <cstdint>
#include <vector>

#include "coordinator/pixel_statistics.h"

namespace strata {

/// What a target asks for next.
struct TargetRound {
  /// For each pixel the samples of each replicate it shall have in all; at least what it has.
  std::vector<uint32_t> ends;
  uint64_t added = 0;          ///< Samples of the round, over all pixels and replicates. 0: no more
                               ///< rounds, since the target is met or its cap is reached.
  double added_deviation = 0;  ///< Standard deviation of `added` as an estimate of what is needed.
  double error = 0;            ///< What is compared with the target, as it stands.
  double met_share = 0;        ///< `--error`: share of the pixels that are narrow enough now.
  bool met = false;
};

/// `--error`: the half-width t(50, 0.975) sqrt(v / n) of every channel is at most `error` times
/// max(luminance, 5 % of the image mean), for 99 % of the pixels. `spp` caps each pixel.
TargetRound PlanForRelativeError(const PixelStatistics& now, double error, uint32_t spp);

/// `--rmse`: sqrt of the mean of stderr^2 over all pixels and channels is at most `rmse`, in the
/// units of the picture. `spp` caps each pixel.
TargetRound PlanForRmse(const PixelStatistics& now, double rmse, uint32_t spp);

}  // namespace strata
