#pragma once

#include <cmath>

#include "worker/math/vec.h"
#include "worker/sampling/disk.h"

// The way back: the point of the unit square that a map of warp.h takes to a direction (PBRT A.5),
// or to the weights of a triangle's corners (PBRT 6.5.4). InvertConcentricDisk is in disk.h.

namespace strata {

inline Vec2f InvertCosineHemisphere(Vec3f w) { return InvertConcentricDisk({w.x, w.y}); }
inline Vec2f InvertUniformHemisphere(Vec3f w) { return {w.z, TurnOf(w.x, w.y)}; }
inline Vec2f InvertUniformSphere(Vec3f w) { return {0.5f * (1 - w.z), TurnOf(w.x, w.y)}; }

/// 1 - cos(theta), accurate for small angles too.
inline float OneMinusCosOf(Vec3f w) {
  const float sin_squared = w.x * w.x + w.y * w.y;
  return w.z > 0 ? sin_squared / (1 + w.z) : 1 - w.z;
}
inline Vec2f InvertUniformCone(Vec3f w, float one_minus_cos_max) {
  return {OneMinusCosOf(w) / one_minus_cos_max, TurnOf(w.x, w.y)};
}

inline Vec2f InvertTriangle(Vec2f b) {
  return b.x > b.y ? Vec2f{b.x + b.y, 2 * b.y} : Vec2f{2 * b.x, b.x + b.y};
}

}  // namespace strata
