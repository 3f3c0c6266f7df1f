#pragma once

#include "worker/math/elementary.h"
#include "worker/math/vec.h"
#include "worker/sampling/disk.h"
#include "worker/sampling/warp.h"

// Half vectors about z with density in proportion to cos^n(theta), the lobe of Blinn (1977, "Models
// of Light Reflection for Computer Synthesized Pictures"; PBRT 2nd ed. 8.4.2); n >= 0. By solid
// angle; that of the reflected direction is HalfVectorToReflectedPdf of it.

namespace strata {

inline Vec3f SampleBlinn(Vec2f u, float n) {
  // 1 - cos(theta) is rounded to float once: a sharp lobe keeps its shape.
  const double cos_theta = Pow(1 - static_cast<double>(u.x), 1 / (n + 1.0));
  return DirectionFromOneMinusCos(static_cast<float>(1 - cos_theta), u.y);
}
inline float BlinnPdf(Vec3f h, float n) {
  return h.z > 0 ? 0.5f * kInvPi * (n + 1) * Pow(h.z, n) : 0;
}
inline Vec2f InvertBlinn(Vec3f h, float n) { return {1 - Pow(h.z, n + 1), TurnOf(h.x, h.y)}; }

}  // namespace strata
