#pragma once

#include <deque>
#include <utility>

#include "coordinator/steady_time.h"
#include "coordinator/time_to_target.h"

namespace strata {

/// A rate over the last few seconds, from totals told from time to time.
class RateMeter {
 public:
  void Tell(double total, SteadyTime now) {
    if (!points_.empty() && now - points_.back().first < std::chrono::milliseconds(100)) return;
    points_.emplace_back(now, total);
    while (points_.size() > 2 && now - points_.front().first > kMemory) {
      points_.pop_front();
    }
  }

  /// Per second; 0 while nothing is known.
  double PerSecond() const {
    if (points_.size() < 2) return 0;
    const std::chrono::duration<double> span = points_.back().first - points_.front().first;
    return (points_.back().second - points_.front().second) / span.count();
  }

  /// The same in spans of a second.
  MeasuredRates Spans() const {
    MeasuredRates rates;
    for (size_t from = 0, to = 1; to < points_.size(); ++to) {
      const std::chrono::duration<double> span = points_[to].first - points_[from].first;
      if (span.count() < rates.span_s) continue;
      rates.per_second.push_back((points_[to].second - points_[from].second) / span.count());
      from = to;
    }
    return rates;
  }

  void Clear() { points_.clear(); }

 private:
  static constexpr std::chrono::seconds kMemory{8};
  std::deque<std::pair<SteadyTime, double>> points_;
};

}  // namespace strata
