#include "coordinator/luminance_floor.h"

#include <algorithm>
#include <bit>
#include <cstdint>

namespace strata {
namespace {

/// To the nearest number of five binary digits. Requires x finite and >= 0.
double RoundToFiveDigits(double x) {
  constexpr uint64_t kDropped = uint64_t{1} << 48;
  const uint64_t bits = std::bit_cast<uint64_t>(x) + kDropped / 2;
  return std::bit_cast<double>(bits & ~(kDropped - 1));
}

}  // namespace

Plane LuminanceFloors(const PixelStatistics& statistics) {
  const PlaneSize size = statistics.size;
  Plane floors(size.Pixels());
  VisitMeansOutside(size, statistics.luminance, [&](size_t y, const double* means) {
    double* row = &floors[y * size.width];
    for (size_t x = 0; x < size.width; ++x) {
      row[x] = RoundToFiveDigits(kLeastShareOfMean * std::max(means[x], 0.0));
    }
  });
  return floors;
}

std::vector<double> DistinctValues(const Plane& plane) {
  std::vector<double> values;  // The one seen last is at the end.
  for (const double value : plane) {
    if (!values.empty() && values.back() == value) continue;
    const auto known = std::find(values.begin(), values.end(), value);
    if (known == values.end()) {
      values.push_back(value);
    } else {
      std::swap(*known, values.back());
    }
  }
  return values;
}

}  // namespace strata
