#pragma once

#include <cmath>

#include "worker/math/vec.h"

namespace strata {

/// Weights of the first two corners of a triangle, uniform by area, by the square-root map (Turk
/// 1990, Graphics Gems; PBRT 3rd ed. 13.6.5): rows of the square end in one corner. SampleTriangle
/// in warp.h distorts less.
inline Vec2f SampleTriangleSqrt(Vec2f u) {
  const float s = std::sqrt(u.x);
  return {1 - s, u.y * s};
}
inline Vec2f InvertTriangleSqrt(Vec2f b) {
  const float s = 1 - b.x;
  return {s * s, s > 0 ? b.y / s : 0};
}
/// Density by area of a point uniform on a triangle.
inline constexpr float TrianglePdf(float area) { return area > 0 ? 1 / area : 0; }

}  // namespace strata
