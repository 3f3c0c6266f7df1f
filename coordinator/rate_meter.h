#pragma once

#include <deque>
#include <utility>

#include "coordinator/steady_time.h"

namespace strata {

/// A rate over the last few seconds, from totals told from time to time.
class RateMeter {
 public:
  void Tell(double total, SteadyTime now) {
    if (!points_.empty() && now - points_.back().first < std::chrono::milliseconds(100)) return;
    points_.emplace_back(now, total);
    while (points_.size() > 2 && now - points_.front().first > std::chrono::seconds(5)) {
      points_.pop_front();
    }
  }

  /// Per second; 0 while nothing is known.
  double PerSecond() const {
    if (points_.size() < 2) return 0;
    const std::chrono::duration<double> span = points_.back().first - points_.front().first;
    return (points_.back().second - points_.front().second) / span.count();
  }

  void Clear() { points_.clear(); }

 private:
  std::deque<std::pair<SteadyTime, double>> points_;
};

}  // namespace strata
