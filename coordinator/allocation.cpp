#include "coordinator/allocation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "coordinator/luminance_floor.h"

namespace strata {
namespace {

constexpr uint32_t kLeastPilot = 32;
constexpr size_t kLeastEdge = 32;

Plane SumOfChannels(const PixelStatistics& statistics) {
  Plane sum = statistics.variance[0];
  for (int c = 1; c < kColours; ++c) {
    const Plane& variance = statistics.variance[c];
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += variance[i];
  }
  return sum;
}

enum class Pool { kRing, kOwnPixel };

/// s = sqrt(weight variance / cost) of each pixel, as its ring shows it or, for the control,
/// itself.
class Shares {
 public:
  Shares(const PixelStatistics& pilot, AllocationGoal goal, Pool pool)
      : size_(pilot.size),
        pool_(pool),
        luminance_(pilot.luminance),
        variance_(SumOfChannels(pilot)),
        cost_(size_.Pixels(), 1.0) {
    if (goal == AllocationGoal::kRelativeError) cost_ = Pooled(pilot.rays);
  }

  /// If relative errors count from `floor` on; 0: errors count as they are, as in an image without
  /// light.
  void Fill(Plane& plane, double floor) const {
    plane = variance_;
    if (floor > 0) {
      for (size_t i = 0; i < plane.size(); ++i) {
        const double scale = 1 / std::max(luminance_[i], floor);
        plane[i] *= scale * scale;
      }
    }
    plane = Pooled(std::move(plane));
    for (size_t i = 0; i < plane.size(); ++i)
      plane[i] = std::sqrt(plane[i] / std::max(cost_[i], 1.0));
  }

 private:
  Plane Pooled(Plane plane) const {
    return pool_ == Pool::kRing ? RingMeans(size_, std::move(plane)) : plane;
  }

  PlaneSize size_;
  Pool pool_;
  const Plane& luminance_;
  Plane variance_, cost_;
};

/// Samples of each replicate for a share, given the mean of all shares.
class Rounding {
 public:
  Rounding(PlaneSize size, uint32_t spp)
      : pilot_(PilotSamples(size, spp)),
        rest_(static_cast<double>(spp) - pilot_),
        most_(kMostOfAverage * spp),
        average_(spp) {}

  uint32_t Count(double share, double mean_share) const {
    double samples = average_;
    if (mean_share > 0) {
      samples = pilot_ + rest_ * (share / mean_share);
    } else if (share > 0) {
      samples = most_;
    }
    return static_cast<uint32_t>(std::floor(std::min(samples, most_) / kReplicates + 0.5));
  }

 private:
  double pilot_, rest_, most_, average_;
};

double Mean(const Plane& plane) {
  return std::accumulate(plane.begin(), plane.end(), 0.0) / static_cast<double>(plane.size());
}

}  // namespace

uint32_t PilotSamples(PlaneSize crop, uint32_t spp) {
  if (crop.width < kLeastEdge || crop.height < kLeastEdge) return spp;
  const uint32_t quarter = (spp + 4 * kReplicates - 1) / (4 * kReplicates) * kReplicates;
  return std::min(spp, std::max(kLeastPilot, quarter));
}

std::vector<uint32_t> AllocateByRing(const PixelStatistics& pilot, uint32_t spp,
                                     AllocationGoal goal) {
  const PlaneSize size = pilot.size;
  std::vector<uint32_t> counts(size.Pixels(), spp / kReplicates);
  if (PilotSamples(size, spp) == spp) return counts;

  const Shares shares(pilot, goal, Pool::kRing);
  const Plane floors =
      goal == AllocationGoal::kRelativeError ? LuminanceFloors(pilot) : Plane(size.Pixels());
  const Rounding rounding(size, spp);
  Plane plane;
  for (const double floor : DistinctValues(floors)) {
    shares.Fill(plane, floor);
    VisitMeansOutside(size, plane, [&](size_t y, const double* means) {
      for (size_t x = 0, i = y * size.width; x < size.width; ++x, ++i) {
        if (floors[i] == floor) counts[i] = rounding.Count(plane[i], means[x]);
      }
    });
  }
  return counts;
}

std::vector<uint32_t> AllocateByOwnPixel(const PixelStatistics& pilot, uint32_t spp,
                                         AllocationGoal goal) {
  std::vector<uint32_t> counts(pilot.size.Pixels(), spp / kReplicates);
  if (PilotSamples(pilot.size, spp) == spp) return counts;
  const double least = goal == AllocationGoal::kRelativeError
                           ? kLeastShareOfMean * std::max(Mean(pilot.luminance), 0.0)
                           : 0.0;
  Plane plane;
  Shares(pilot, goal, Pool::kOwnPixel).Fill(plane, least);
  const double mean = Mean(plane);
  const Rounding rounding(pilot.size, spp);
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = rounding.Count(plane[i], mean);
  return counts;
}

}  // namespace strata
