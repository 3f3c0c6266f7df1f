#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/vec.h"

namespace strata {

/// A point that wants light. What it is lit by depends on no more than this.
struct LightReceiver {
  Vec3f p;
  Vec3f n;                 ///< Unit shading normal; if one_sided, on the side that is seen.
  bool one_sided = false;  ///< Nothing passes through: light from behind n is in vain.
};

/// Where a light, or a group of them, is and where it shines (Conty Estevez and Kulla 2018, with
/// the box's sphere; PBRT 12.6.3). All emit as Lambert's law says or evenly around.
struct LightBounds {
  Vec3f min, max;
  Vec3f axis = {0, 0, 1};  ///< Unit: the normals lie in a cone around it.
  float cos_spread = -1;   ///< Of the cone's half-angle; -1: anywhere.
  float intensity = 0;     ///< Luminance of the intensity along a normal. Relative.
  bool two_sided = false;

  Vec3f Center() const { return (min + max) * 0.5f; }
};

namespace light_bounds_detail {

/// cos(max(0, a - b)) and its sine.
inline float CosSubClamped(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 1 : cos_a * cos_b + sin_a * sin_b;
}
inline float SinSubClamped(float sin_a, float cos_a, float sin_b, float cos_b) {
  return cos_a > cos_b ? 0 : sin_a * cos_b - cos_a * sin_b;
}
inline float SinOf(float cosine) { return std::sqrt(std::max(0.0f, 1 - cosine * cosine)); }

/// Cosines are known to some roundings: what faces away by no more than this may still give light,
/// and what faces edge-on keeps a chance.
inline constexpr float kSlack = 1e-3f;
inline float Facing(float cosine) { return cosine < -kSlack ? 0 : std::max(cosine, kSlack); }

}  // namespace light_bounds_detail

/// How much light may come from there, but for what hides it: never 0 where some does.
inline float Importance(const LightBounds& light, const LightReceiver& receiver) {
  using namespace light_bounds_detail;
  // Squares of distances stay within float's range for any scene.
  constexpr float kLeast = 1e-36f, kMost = 1e36f;
  const Vec3f to = receiver.p - light.Center();
  const float distance2 = std::min(LengthSquared(to), kMost);
  const float radius2 = 1.001f * LengthSquared((light.max - light.min) * 0.5f);
  if (!(distance2 > radius2)) return light.intensity / std::max(radius2, kLeast);

  const float inverse = 1 / std::sqrt(distance2);
  const float sin_size2 = radius2 / distance2;
  const float sin_size = std::sqrt(sin_size2), cos_size = std::sqrt(1 - sin_size2);
  float facing = 1;
  if (light.cos_spread > -1) {
    float cosine = Dot(light.axis, to) * inverse;
    if (light.two_sided) cosine = std::abs(cosine);
    const float sine = SinOf(cosine), sin_spread = SinOf(light.cos_spread);
    facing = Facing(CosSubClamped(SinSubClamped(sine, cosine, sin_spread, light.cos_spread),
                                  CosSubClamped(sine, cosine, sin_spread, light.cos_spread),
                                  sin_size, cos_size));
  }
  float incident = -Dot(receiver.n, to) * inverse;
  if (!receiver.one_sided) incident = std::abs(incident);
  const float lit = Facing(CosSubClamped(SinOf(incident), incident, sin_size, cos_size));
  return light.intensity * facing * lit * (inverse * inverse);
}

/// What bounds both.
LightBounds Union(const LightBounds& a, const LightBounds& b);

}  // namespace strata
