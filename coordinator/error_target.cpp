#include "coordinator/error_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

namespace strata {
namespace {

/// One pixel in so many may miss the target. Half of them are planned to: the pixels that need
/// most. The other half is for those whose variance turns out larger than the pilot said.
constexpr size_t kMayMiss = 100;
constexpr size_t kPlannedToMiss = 2 * kMayMiss;

/// A ring's variance has at most 24 * 7 degrees of freedom: a standard error of 11 % or more, and
/// two rounds share a part of theirs. Without a margin half of the pixels would want a second
/// round. 1.15 spends 15 % and saves most of it: see the figures in
/// tests/farm/error_target_test.cpp.
constexpr double kMargin = 1.15;

constexpr double kDegrees = kReplicates - 1;

/// The 5x5 around a pixel, clipped: calls visit(index).
template <typename Visit>
void ForEachInside(PlaneSize size, size_t i, Visit visit) {
  constexpr size_t kReach = Neighbourhoods::kReach;
  const size_t x = i % size.width, y = i / size.width;
  for (size_t v = y - std::min(y, kReach); v < std::min(y + kReach + 1, size.height); ++v) {
    for (size_t u = x - std::min(x, kReach); u < std::min(x + kReach + 1, size.width); ++u) {
      visit(v * size.width + u);
    }
  }
}

/// The samples over all replicates each pixel needs, judged by others; infinite where there is
/// noise and no light to measure it by.
std::vector<double> Needs(const PixelStatistics& now, double error) {
  std::vector<double> needs = RingMeans(now.size, now.variance[0]);
  for (int c = 1; c < kColours; ++c) {
    const std::vector<double> variance = RingMeans(now.size, now.variance[c]);
    for (size_t i = 0; i < needs.size(); ++i) needs[i] = std::max(needs[i], variance[i]);
  }
  const std::vector<double> luminance = RingMeans(now.size, now.luminance);
  VisitMeansOutside(now.size, now.luminance, [&](size_t y, const double* means) {
    for (size_t x = 0, i = y * now.size.width; x < now.size.width; ++x, ++i) {
      const double widest =
          error / kStudent50 * std::max({luminance[i], kLeastShareOfMean * means[x], 0.0});
      if (needs[i] > 0) needs[i] /= widest * widest;
    }
  });
  return needs;
}

/// Figures of all judged pixels outside of the 5x5 around one.
class Outside {
 public:
  Outside(const PixelStatistics& now, const std::vector<double>& needs) : now_(now), needs_(needs) {
    for (size_t i = 0; i < needs.size(); ++i) {
      if (now.nonfinite[i]) continue;
      highest_.push_back(needs[i]);
      unmet_ += !Met(i);
    }
    judged_ = highest_.size();
    const size_t kept = std::min(judged_, judged_ / kPlannedToMiss + 1 + kInside);
    const auto end = highest_.begin() + static_cast<ptrdiff_t>(kept);
    std::nth_element(highest_.begin(), end, highest_.end(), std::greater<>());
    highest_.resize(kept);
    std::sort(highest_.begin(), highest_.end(), std::greater<>());
  }

  bool Met(size_t i) const {
    return static_cast<double>(now_.samples[i]) * kReplicates >= needs_[i];
  }
  size_t judged() const { return judged_; }
  size_t unmet() const { return unmet_; }

  /// Whether more of them miss the target than may.
  bool TooManyUnmet(size_t i) const {
    if (unmet_ > judged_ / kMayMiss + kInside) return true;
    size_t judged = judged_, unmet = unmet_;
    ForEachInside(now_.size, i, [&](size_t j) {
      judged -= !now_.nonfinite[j];
      unmet -= !now_.nonfinite[j] && !Met(j);
    });
    return unmet > judged / kMayMiss;
  }

  /// The most that any of them needs that is to meet the target; infinite where there is none.
  double Limit(size_t i) const {
    if (highest_.empty() || needs_[i] <= highest_.back()) return needs_[i];
    std::array<double, kInside> inside;
    size_t count = 0;
    ForEachInside(now_.size, i, [&](size_t j) {
      if (!now_.nonfinite[j]) inside[count++] = needs_[j];
    });
    std::sort(inside.begin(), inside.begin() + count, std::greater<>());
    // Each one left out that ranks before the limit moves it down by one.
    size_t rank = (judged_ - count) / kPlannedToMiss;
    for (size_t k = 0; k < count && rank < highest_.size() && inside[k] >= highest_[rank]; ++k) {
      ++rank;
    }
    return rank < highest_.size() ? highest_[rank] : std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr size_t kInside = 25;

  const PixelStatistics& now_;
  const std::vector<double>& needs_;
  std::vector<double> highest_;  ///< Descending, as many as can matter.
  size_t judged_ = 0, unmet_ = 0;
};

/// `error` times the square root of what the pixel at the allowed quantile lacks.
double ErrorNow(const PixelStatistics& now, const std::vector<double>& needs, double error) {
  std::vector<double> lacks;
  for (size_t i = 0; i < needs.size(); ++i) {
    if (!now.nonfinite[i]) lacks.push_back(needs[i] / (double{kReplicates} * now.samples[i]));
  }
  if (lacks.empty()) return 0;
  const auto place = lacks.begin() + static_cast<ptrdiff_t>(lacks.size() / kMayMiss);
  std::nth_element(lacks.begin(), place, lacks.end(), std::greater<>());
  return error * std::sqrt(*place);
}

}  // namespace

TargetRound PlanCap(const PixelStatistics& now, uint32_t spp) {
  TargetRound round{now.samples};
  for (uint32_t& end : round.ends) {
    const uint32_t more = std::max(end, spp / kReplicates) - end;
    round.added += uint64_t{kReplicates} * more;
    end += more;
  }
  round.error = std::numeric_limits<double>::infinity();
  return round;
}

TargetRound PlanForRelativeError(const PixelStatistics& now, double error, uint32_t spp) {
  if (!HasOutside(now.size)) return PlanCap(now, spp);
  const double cap = spp / kReplicates;
  const std::vector<double> needs = Needs(now, error);
  const Outside outside(now, needs);
  TargetRound round{now.samples};
  double squares = 0;
  for (size_t i = 0; i < needs.size(); ++i) {
    if (outside.Met(i) || !outside.TooManyUnmet(i)) continue;
    const double wanted =
        std::min(std::ceil(kMargin / kReplicates * std::min(needs[i], outside.Limit(i))), cap);
    if (!(wanted > now.samples[i])) continue;
    round.ends[i] = static_cast<uint32_t>(wanted);
    round.added += uint64_t{kReplicates} * (round.ends[i] - now.samples[i]);
    if (wanted < cap) squares += wanted * wanted;
  }
  // Each pixel's 7 degrees of freedom count once, if in the rings of others.
  round.added_deviation = kReplicates * std::sqrt(2 / kDegrees * squares);
  round.error = ErrorNow(now, needs, error);
  const size_t judged = outside.judged(), unmet = outside.unmet();
  round.met = unmet <= judged / kMayMiss;
  round.met_share = judged > 0 ? 1 - static_cast<double>(unmet) / static_cast<double>(judged) : 1;
  return round;
}

}  // namespace strata
