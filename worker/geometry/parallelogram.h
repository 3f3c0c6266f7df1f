#pragma once

#include <array>
#include <cmath>
#include <optional>

#include "worker/math/vec.h"

namespace strata {

struct Parallelogram {
  Vec3f corner, edge1, edge2;
  Vec3f off;  ///< By how much the surface's fourth corner misses corner + edge1 + edge2.
};

/// The parallelogram that two triangles with a common edge make, if they do, within 1e-6 of its
/// size. Their normals are not looked at.
inline std::optional<Parallelogram> ParallelogramOf(const std::array<Vec3f, 3>& p,
                                                    const std::array<Vec3f, 3>& q) {
  for (size_t i = 0; i < 3; ++i) {
    // The corner of the first triangle across from the common edge, which is a diagonal.
    const Vec3f corner = p[i], s = p[(i + 1) % 3], t = p[(i + 2) % 3];
    for (size_t j = 0; j < 3; ++j) {
      const Vec3f u = q[(j + 1) % 3], v = q[(j + 2) % 3];
      if (!((u == s && v == t) || (u == t && v == s))) continue;
      const Vec3f edge1 = s - corner, edge2 = t - corner;
      const float size = Length(edge1) + Length(edge2);
      const Vec3f off = q[j] - (s + edge2);
      if (std::isfinite(size) && Length(off) <= 1e-6f * size)
        return Parallelogram{corner, edge1, edge2, off};
    }
  }
  return std::nullopt;
}

}  // namespace strata
