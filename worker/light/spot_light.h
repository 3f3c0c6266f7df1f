#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "worker/light/delta_lights.h"
#include "worker/light/light_sample.h"
#include "worker/math/elementary.h"
#include "worker/math/vec.h"

namespace strata {

/// A point that shines into a cone, less and less towards its edge (PBRT 12.2.1). Angles are given
/// by their versine, 1 - cos, which tells the narrowest ones apart.
struct SpotLight {
  Vec3f position;
  Vec3f axis;               ///< World, unit, away from the light.
  Rgb intensity;            ///< Along the axis.
  float versine_start = 0;  ///< Of the angle up to which all is as on the axis,
  float versine_end = 0;    ///< and of that beyond which all is dark; not below.
};

inline double VersineOfDegrees(double degrees) {
  const double sine = Sin(degrees * (std::numbers::pi / 360));
  return 2 * sine * sine;
}

inline float VersineTo(const SpotLight& light, Vec3f w) {
  return 0.5f * LengthSquared(w - light.axis);
}

/// Part of the full intensity at an angle: a smooth step in its cosine.
inline float Falloff(const SpotLight& light, float versine) {
  if (versine <= light.versine_start) return 1;
  if (!(versine < light.versine_end)) return 0;
  const float t = (light.versine_end - versine) / (light.versine_end - light.versine_start);
  return t * t * (3 - 2 * t);
}

/// The falloff's integral over all directions, in steradians: the step's mean is a half.
template <typename T>
T FalloffIntegral(T versine_start, T versine_end) {
  return std::numbers::pi_v<T> * (versine_start + versine_end);
}

/// The versine of an angle chosen in proportion to the falloff, by solid angle.
inline float SampleFalloff(const SpotLight& light, float u) {
  const float even = 2 * light.versine_start / (light.versine_start + light.versine_end);
  if (u < even) return light.versine_start * (u / even);
  // t has the distribution function 2 t^3 - t^4, which is convex: from the right Newton's steps
  // come closer without end.
  u = std::min((u - even) / (1 - even), 1.0f);
  float t = Pow(u, 1.0f / 3);
  for (int step = 0; step < 6 && t > 0; ++step)
    t -= (t * t * t * (2 - t) - u) / (t * t * (6 - 4 * t));
  return light.versine_end - t * (light.versine_end - light.versine_start);
}

/// Intensity towards `w`, world and unit, away from the light.
inline Rgb Intensity(const SpotLight& light, Vec3f w) {
  return light.intensity * Falloff(light, VersineTo(light, w));
}

inline std::optional<LightSample> SampleLi(const SpotLight& light, Vec3f from, Vec2f /*u*/) {
  return SampleFromPoint(light, from);
}

}  // namespace strata
