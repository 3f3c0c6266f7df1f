#pragma once

#include <vector>

namespace strata {

/// What is still to be rendered, with its standard error (`added` of a TargetRound).
struct RemainingSamples {
  double expected = 0;
  double deviation = 0;
};

/// Samples per second as measured lately, in consecutive spans of equal length.
struct MeasuredRates {
  double span_s = 1;
  std::vector<double> per_second;
};

/// When a target will be reached.
struct TimeToTarget {
  double samples = 0;
  double seconds = -1;  ///< Negative: unknown, as no rate is.
  /// The interval holds the true time in about 90 % of all cases; negative: unknown.
  double low_seconds = -1, high_seconds = -1;
};

/// seconds = samples / mean rate. The rate of the time to come, m spans long, is the mean of m
/// numbers like the k measured ones, so the difference of the two means has the variance
/// s^2 (1/k + 1/m) and Student's distribution with k - 1 degrees of freedom. Its relative
/// error and that of the samples add in quadrature, and the interval is symmetric in the logarithm.
/// That spans are alike and independent is assumed: an interval cannot know of workers that come or
/// go. With fewer than two spans there is no interval.
TimeToTarget PredictTimeToTarget(const RemainingSamples& remaining, const MeasuredRates& rates);

}  // namespace strata
