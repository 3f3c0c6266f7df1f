#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"
#include "worker/sampling/choose.h"

// The unit disk beside the concentric map of warp.h, and the way back from both.

namespace strata {

/// The angle of (x, y) in parts of a full turn, in [0, 1).
inline float TurnOf(float x, float y) {
  const float turn = Atan2(y, x) * (0.5f * kInvPi);
  return turn < 0 ? std::min(turn + 1, kBelowOne) : turn;
}

/// Point of the unit disk, uniform by area, by polar coordinates (PBRT A.5.1): cells of the square
/// near the centre become slivers. The density is ConcentricDiskPdf.
inline Vec2f SamplePolarDisk(Vec2f u) {
  const float r = std::sqrt(u.x);
  const SinCosResult<float> phi = SinCos2Pi(u.y);
  return {r * phi.cos, r * phi.sin};
}
inline Vec2f InvertPolarDisk(Vec2f p) { return {p.x * p.x + p.y * p.y, TurnOf(p.x, p.y)}; }

/// The point of the square that SampleConcentricDisk takes to p.
inline Vec2f InvertConcentricDisk(Vec2f p) {
  const bool a_larger = std::fabs(p.x) > std::fabs(p.y);
  const float larger = a_larger ? p.x : p.y, smaller = a_larger ? p.y : p.x;
  if (larger == 0) return {0.5f, 0.5f};
  const float radius = std::copysign(std::sqrt(p.x * p.x + p.y * p.y), larger);
  const float other = radius * Atan2(smaller / larger, 1.0f) * (4 * kInvPi);
  const Vec2f square = a_larger ? Vec2f{radius, other} : Vec2f{other, radius};
  return {0.5f + 0.5f * square.x, 0.5f + 0.5f * square.y};
}

}  // namespace strata
