#pragma once

#include <vector>

namespace strata {

/// What is still to be done, with its standard deviation (TargetRound's `added`).
struct RemainingSamples {
  double expected = 0;
  double deviation = 0;
};

/// Samples per second as measured lately, in consecutive spans of equal length.
struct MeasuredRates {
  double span_s = 1;
  std::vector<double> per_second;
};

/// When a target will be reached. The interval holds the true time in about 90 % of all cases, if
/// the rate goes on to vary as it did.
struct TimeToTarget {
  double samples = 0;
  double seconds = -1;                       ///< Negative: unknown, as no rate was measured.
  double low_seconds = 0, high_seconds = 0;  ///< `high_seconds` may be infinite.
};

TimeToTarget PredictTimeToTarget(const RemainingSamples& remaining, const MeasuredRates& rates);

}  // namespace strata
