#include "coordinator/time_to_target.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>

namespace strata {
namespace {

/// t(k, 0.95) for k = 1, 2, ... degrees of freedom, from tables; the last is for all others.
double Student95(size_t degrees) {
  constexpr double kQuantiles[] = {6.314, 2.920, 2.353, 2.132, 2.015, 1.943, 1.895, 1.860,
                                   1.833, 1.812, 1.796, 1.782, 1.771, 1.761, 1.753, 1.746,
                                   1.740, 1.734, 1.729, 1.725, 1.721, 1.717, 1.714, 1.711,
                                   1.708, 1.706, 1.703, 1.701, 1.699, 1.697};
  return kQuantiles[std::min(degrees, std::size(kQuantiles)) - 1];
}

}  // namespace

TimeToTarget PredictTimeToTarget(const RemainingSamples& remaining, const MeasuredRates& rates) {
  TimeToTarget time{remaining.expected};
  if (!(remaining.expected > 0)) return {0, 0, 0, 0};
  const double spans = static_cast<double>(rates.per_second.size());
  const double mean =
      std::accumulate(rates.per_second.begin(), rates.per_second.end(), 0.0) / std::max(spans, 1.0);
  if (!(mean > 0)) return time;
  time.seconds = remaining.expected / mean;
  if (rates.per_second.size() < 2) return time;

  double squares = 0;
  for (const double rate : rates.per_second) squares += (rate - mean) * (rate - mean);
  const double spans_ahead = std::max(time.seconds / rates.span_s, 1.0);
  const double rate_deviation =
      std::sqrt(squares / (spans - 1) * (1 / spans + 1 / spans_ahead)) / mean;
  // The samples' error is normal, that of the rate is Student's; each has its own quantile.
  const double of_rate = Student95(rates.per_second.size() - 1) * rate_deviation;
  const double of_samples = 1.645 * remaining.deviation / remaining.expected;
  const double factor = std::exp(std::hypot(of_rate, of_samples));
  time.low_seconds = time.seconds / factor;
  time.high_seconds = time.seconds * factor;
  return time;
}

}  // namespace strata
