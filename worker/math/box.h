#pragma once

#include <algorithm>
#include <array>

#include "worker/math/transform.h"

namespace strata {

/// A box along the axes; holds nothing until it is given points.
struct Box {
  Vec3d min = {1e300, 1e300, 1e300}, max = {-1e300, -1e300, -1e300};

  void Include(Vec3d p) {
    min = {std::min(min.x, p.x), std::min(min.y, p.y), std::min(min.z, p.z)};
    max = {std::max(max.x, p.x), std::max(max.y, p.y), std::max(max.z, p.z)};
  }
  void Include(const Box& other) {
    if (other.Empty()) return;
    Include(other.min);
    Include(other.max);
  }
  bool Empty() const { return min.x > max.x; }
  std::array<Vec3d, 8> Corners() const {
    std::array<Vec3d, 8> corners;
    for (size_t i = 0; i < corners.size(); ++i)
      corners[i] = {i & 1 ? max.x : min.x, i & 2 ? max.y : min.y, i & 4 ? max.z : min.z};
    return corners;
  }
};

}  // namespace strata
