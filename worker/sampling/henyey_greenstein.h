#pragma once

#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"
#include "worker/sampling/disk.h"
#include "worker/sampling/warp.h"
#include "worker/sampling/warp_inverse.h"

// The phase function of Henyey and Greenstein (1941; PBRT 11.3.1): its own density by solid angle.
// Directions are local: light travels along +z before, along w after. g in (-1, 1) is the mean of
// w.z; PBRT measures its angle to -z. None of the forms below cancels or divides by g, so that g =
// 0 and sharp lobes need no cases of their own.

namespace strata {

inline float HenyeyGreensteinPdf(Vec3f w, float g) {
  const float base = (1 - g) * (1 - g) + 2 * g * OneMinusCosOf(w);
  return 0.25f * kInvPi * (1 - g) * (1 + g) / (base * std::sqrt(base));
}

inline Vec3f SampleHenyeyGreenstein(Vec2f u, float g) {
  // 1 - cos(theta), factored; u.x = 0 is the axis.
  const float v = 1 - u.x;
  const float root = 1 - g + 2 * g * v;
  return DirectionFromOneMinusCos(2 * u.x * (1 - g) * (1 - g) * (1 + g * v) / (root * root), u.y);
}

inline Vec2f InvertHenyeyGreenstein(Vec3f w, float g) {
  const float one_minus_cos = OneMinusCosOf(w);
  const float r = std::sqrt((1 - g) * (1 - g) + 2 * g * one_minus_cos);
  // 1 - u.x = (r - (1 - g)) (1 + g) / (2 g r), multiplied out.
  const float after = one_minus_cos * (1 + g) / (r * (r + 1 - g));
  return {after, TurnOf(w.x, w.y)};
}

}  // namespace strata
