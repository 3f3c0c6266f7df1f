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

std::vector<double> SumOfChannels(const PixelStatistics& statistics) {
  std::vector<double> sum = statistics.variance[0];
  for (int c = 1; c < kColours; ++c) {
    const std::vector<double>& variance = statistics.variance[c];
    for (size_t i = 0; i < sum.size(); ++i) sum[i] += variance[i];
  }
  return sum;
}

/// What a pixel's share is made of, at its place: sqrt(variance / cost), and the luminance it is
/// divided by.
struct Shares {
  std::vector<double> deviation, luminance;

  /// s of a pixel if relative errors count from `least_luminance` on. In an image without light
  /// no error is relative.
  double Share(size_t i, double least_luminance) const {
    if (!(least_luminance > 0)) return deviation[i];
    return deviation[i] / std::max(luminance[i], least_luminance);
  }
  void Fill(std::vector<double>& plane, double least_luminance) const {
    plane.resize(deviation.size());
    for (size_t i = 0; i < plane.size(); ++i) plane[i] = Share(i, least_luminance);
  }
};

Shares SharesOf(std::vector<double> variance, const std::vector<double>& rays,
                std::vector<double> luminance, AllocationGoal goal) {
  Shares shares{std::move(variance), std::move(luminance)};
  for (size_t i = 0; i < shares.deviation.size(); ++i) {
    const double cost = goal == AllocationGoal::kRelativeError ? std::max(rays[i], 1.0) : 1.0;
    shares.deviation[i] = std::sqrt(shares.deviation[i] / cost);
  }
  return shares;
}

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

double Mean(const std::vector<double>& plane) {
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

  const Shares shares = SharesOf(RingMeans(size, SumOfChannels(pilot)), RingMeans(size, pilot.rays),
                                 RingMeans(size, pilot.luminance), goal);
  const std::vector<double> floors = goal == AllocationGoal::kRelativeError
                                         ? LuminanceFloors(pilot)
                                         : std::vector<double>(size.Pixels());
  const Rounding rounding(size, spp);
  std::vector<double> plane;
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
  std::vector<double> plane;
  SharesOf(SumOfChannels(pilot), pilot.rays, pilot.luminance, goal).Fill(plane, least);
  const double mean = Mean(plane);
  const Rounding rounding(pilot.size, spp);
  for (size_t i = 0; i < counts.size(); ++i) counts[i] = rounding.Count(plane[i], mean);
  return counts;
}

}  // namespace strata
