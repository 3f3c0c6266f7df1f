#include "coordinator/error_target.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "coordinator/luminance_floor.h"

namespace strata {
namespace {

/// One pixel in so many may miss the target. Half of them are planned to: the pixels that need
/// most. The other half is for those whose variance turns out larger than the pilot said.
constexpr size_t kMayMiss = 100;
constexpr size_t kPlannedToMiss = 2 * kMayMiss;

/// The variance of a half ring has at most 14 * 7 degrees of freedom: a standard error of 14 % or
/// more. Without a margin pixels stop at the look that happens to flatter them, after eight rounds.
/// docs/accuracy.md has the share that truly meets the target with this one, and the price.
constexpr double kNeedMargin = 1.25;

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

/// What tells how many samples pixels need, over all replicates, if errors are relative from
/// `floor` on; infinite where there is noise and no light to measure it by.
class Needs {
 public:
  Needs(const PixelStatistics& now, double error) : now_(now), widest_(error / kStudent25) {}

  /// Of each pixel as its ring shows it: the half of it that needs most.
  void Fill(Plane& needs, double floor) const {
    needs.assign(now_.luminance.size(), 0.0);
    Plane plane(needs.size());
    for (const Plane& variance : now_.variance) {
      for (size_t i = 0; i < plane.size(); ++i) plane[i] = Need(variance[i], i, floor);
      plane = HighestHalfMeans(now_.size, std::move(plane));
      for (size_t i = 0; i < needs.size(); ++i) needs[i] = std::max(needs[i], plane[i]);
    }
  }

  /// Of a pixel as it shows itself. Decides nothing.
  double Own(size_t i, double floor) const {
    double need = 0;
    for (const Plane& variance : now_.variance) {
      need = std::max(need, Need(variance[i], i, floor));
    }
    return need;
  }

 private:
  double Need(double variance, size_t i, double floor) const {
    const double widest = widest_ * std::max(now_.luminance[i], floor);
    return variance > 0 ? variance / (widest * widest) : 0;
  }

  const PixelStatistics& now_;
  double widest_;
};

/// How the image stands for one pixel: the pixels outside of its 5x5 as they are, and those inside,
/// whose rings have it in them, as if they needed more than any other. So it is the harder to
/// please the smaller the image is, and it never stops while more than may miss the target do.
class Outside {
 public:
  Outside(const PixelStatistics& now, const Plane& needs) : now_(now), needs_(needs) {
    highest_.reserve(needs.size());
    for (size_t i = 0; i < needs.size(); ++i) {
      if (now.nonfinite[i]) continue;
      highest_.push_back(needs[i]);
      unmet_ += !Met(i);
    }
    judged_ = highest_.size();
    const size_t kept = std::min(judged_, (judged_ + kInside) / kPlannedToMiss + 1);
    const auto end = highest_.begin() + static_cast<ptrdiff_t>(kept);
    std::nth_element(highest_.begin(), end, highest_.end(), std::greater<>());
    highest_.resize(kept);
    std::sort(highest_.begin(), highest_.end(), std::greater<>());
  }

  bool Met(size_t i) const {
    return static_cast<double>(now_.samples[i]) * kReplicates >= needs_[i];
  }

  /// Whether more pixels miss the target than may.
  bool TooManyUnmet(size_t i) const {
    // What is inside can move neither answer.
    if (unmet_ > judged_ / kMayMiss) return true;
    if (unmet_ + kInside <= judged_ / kMayMiss) return false;
    size_t judged = judged_, unmet = unmet_;
    ForEachInside(now_.size, i, [&](size_t j) {
      judged += now_.nonfinite[j];
      unmet += now_.nonfinite[j] || Met(j);
    });
    return unmet > judged / kMayMiss;
  }

  /// The most that any pixel outside needs that is to meet the target; infinite where all are.
  double Limit(size_t i) const {
    if (highest_.empty() || needs_[i] <= highest_.back()) return needs_[i];
    std::array<double, kInside> inside;
    size_t count = 0, all = 0;
    ForEachInside(now_.size, i, [&](size_t j) {
      ++all;
      if (!now_.nonfinite[j]) inside[count++] = needs_[j];
    });
    const size_t planned_to_miss = (judged_ - count + all) / kPlannedToMiss;
    if (planned_to_miss < all) return std::numeric_limits<double>::infinity();
    std::sort(inside.begin(), inside.begin() + count, std::greater<>());
    // Each one left out that ranks before the limit moves it down by one.
    size_t rank = planned_to_miss - all;
    for (size_t k = 0; k < count && rank < highest_.size() && inside[k] >= highest_[rank]; ++k) {
      ++rank;
    }
    return rank < highest_.size() ? highest_[rank] : std::numeric_limits<double>::infinity();
  }

 private:
  static constexpr size_t kInside = 25;

  const PixelStatistics& now_;
  const Plane& needs_;
  Plane highest_;  ///< Descending, as many as can matter.
  size_t judged_ = 0, unmet_ = 0;
};

/// Adds to a round what pixel i shall have. Returns the number of samples of a replicate it was
/// given, unless this is the cap.
double PlanPixel(const PixelStatistics& now, const Outside& outside, size_t i, double need,
                 double cap, TargetRound& round) {
  if (outside.Met(i) || !outside.TooManyUnmet(i)) return 0;
  const double wanted =
      std::min(std::ceil(kNeedMargin / kReplicates * std::min(need, outside.Limit(i))), cap);
  if (!(wanted > now.samples[i])) return 0;
  round.ends[i] = static_cast<uint32_t>(wanted);
  round.added += uint64_t{kReplicates} * (round.ends[i] - now.samples[i]);
  return wanted < cap ? wanted : 0;
}

/// Completes a round by how things stand: `lacks` are the judged pixels' needs over what they have.
void Judge(Plane lacks, double error, TargetRound& round) {
  round.met = true;
  round.met_share = 1;
  if (lacks.empty()) return;
  const auto met = std::count_if(lacks.begin(), lacks.end(), [](double lack) { return lack <= 1; });
  round.met_share = static_cast<double>(met) / static_cast<double>(lacks.size());

  const size_t may_miss = lacks.size() / kMayMiss;
  const auto ranked = [&](size_t rank) {
    const auto place = lacks.begin() + static_cast<ptrdiff_t>(std::min(rank, lacks.size() - 1));
    std::nth_element(lacks.begin(), place, lacks.end(), std::greater<>());
    return *place;
  };
  const double lack = ranked(may_miss);
  round.error = error * std::sqrt(lack);
  round.met = lack <= 1;
  // Pixels that share a ring rise and fall together, some five of them, so that of those above a
  // value about sqrt(5 k) more or less than k are.
  const size_t more = static_cast<size_t>(std::sqrt(5.0 * static_cast<double>(may_miss + 1)));
  const double high = ranked(may_miss - std::min(may_miss, more)), low = ranked(may_miss + more);
  if (std::isfinite(high) && lack > 0) round.square_deviation = (high - low) / (2 * lack);
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
  const Needs all_needs(now, error);
  const Plane floors = LuminanceFloors(now);
  TargetRound round{now.samples};
  Plane needs, lacks;
  lacks.reserve(floors.size());
  double squares = 0;
  for (const double floor : DistinctValues(floors)) {
    all_needs.Fill(needs, floor);
    const Outside outside(now, needs);
    for (size_t i = 0; i < needs.size(); ++i) {
      if (floors[i] != floor) continue;
      const double given = PlanPixel(now, outside, i, needs[i], spp / kReplicates, round);
      squares += given * given;
      if (now.nonfinite[i]) continue;
      const double need = needs[i] > 0 ? needs[i] : all_needs.Own(i, floor);
      lacks.push_back(need / (double{kReplicates} * now.samples[i]));
    }
  }
  // Each pixel's 7 degrees of freedom count once, if in the rings of others.
  round.added_deviation = kReplicates * std::sqrt(2 / kDegrees * squares);
  Judge(std::move(lacks), error, round);
  return round;
}

}  // namespace strata
