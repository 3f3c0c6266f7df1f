#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "bench/calibration_figures.h"
#include "coordinator/ring_pool.h"

// Allocations that know the variances (Neyman 1934), for weight and cost 1.

namespace strata {

/// Of one sample, summed over colours, for each pixel. `samples` were in each trial.
inline std::vector<double> VarianceOfASample(const Reference& reference, double samples) {
  std::vector<double> variance(reference.variance.size() / kColours);
  for (size_t i = 0; i < reference.variance.size(); ++i) {
    variance[i / kColours] += samples * reference.variance[i];
  }
  return variance;
}

/// Over the 5x5 pixels around each one and itself, clipped at the border.
inline std::vector<double> BlockMeans(PlaneSize size, const std::vector<double>& plane) {
  constexpr size_t kReach = Neighbourhoods::kReach;
  std::vector<double> means;
  for (size_t y = 0; y < size.height; ++y) {
    for (size_t x = 0; x < size.width; ++x) {
      double sum = 0, pixels = 0;
      for (size_t v = y - std::min(y, kReach); v < std::min(y + kReach + 1, size.height); ++v) {
        for (size_t u = x - std::min(x, kReach); u < std::min(x + kReach + 1, size.width); ++u) {
          sum += plane[v * size.width + u];
          pixels += 1;
        }
      }
      means.push_back(sum / pixels);
    }
  }
  return means;
}

/// Samples of each replicate, with `spp` samples for a pixel on average and at least `floor`:
/// max(floor, c sqrt(variance)), the least error there is under this floor.
inline std::vector<uint32_t> NeymanCounts(const std::vector<double>& variance, double spp,
                                          double floor) {
  const auto samples = [&](double c, size_t i) {
    return std::max(floor, c * std::sqrt(variance[i]));
  };
  const double wanted = spp * static_cast<double>(variance.size());
  double low = 0, high = 1;
  const auto all = [&](double c) {
    double sum = 0;
    for (size_t i = 0; i < variance.size(); ++i) sum += samples(c, i);
    return sum;
  };
  while (all(high) < wanted) high *= 2;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (all(middle) < wanted ? low : high) = middle;
  }
  std::vector<uint32_t> counts;
  for (size_t i = 0; i < variance.size(); ++i) {
    counts.push_back(static_cast<uint32_t>(std::floor(samples(high, i) / kReplicates + 0.5)));
  }
  return counts;
}

}  // namespace strata
