#pragma once

#include <algorithm>

#include "worker/math/lanes.h"

// Russian roulette (PBRT 2.2.4): an estimate F is replaced by F', which is cheap with probability q
// and has the same mean.

namespace strata {

/// F' in the general form: (F - q c) / (1 - q) where it goes on, c where it does not. The paths of
/// the kernels have c = 0. Value is float, double or Rgb.
template <typename Value>
struct Roulette {
  float q = 0;   ///< Probability of ending, in [0, 1).
  Value c = {};  ///< What stands for the rest then; any value keeps the mean.

  /// Whether the uniform number u in [0, 1) ends it.
  bool Ends(float u) const { return u < q; }
  Value Survivor(Value f) const { return (f + c * -q) * (1 / (1 - q)); }
};

/// The variance of F' from mean and variance of F: least for c = mean, and never less than F's.
inline double RouletteVariance(double mean, double variance, double q, double c) {
  return variance / (1 - q) + q / (1 - q) * (mean - c) * (mean - c);
}

/// However dark a path, it goes on with this probability: weights stay bounded.
inline constexpr float kMinSurvival = 0.05f;

/// Survival of a path of that throughput, where from `sure` on all survive. For throughputs below
/// `sure` alone.
inline float SurvivalProbability(float throughput, float sure) {
  return std::max(throughput / sure, kMinSurvival);
}
inline FloatLanes SurvivalProbability(FloatLanes throughput, FloatLanes sure) {
  return Max(throughput / sure, SameFloat(kMinSurvival));
}

/// Shadow rays are surely traced where what they may add, if nothing is in the way, is at least
/// this part of what the path has found so far. The others survive with SurvivalProbability(what
/// they may add, this part of what was found): each adds to the square of what was found at most
/// 1/64 of it, and so to the variance (docs/decisions.md has what other parts gave).
inline constexpr float kSureShadow = 0.25f;

}  // namespace strata
