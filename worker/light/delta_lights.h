#pragma once

#include <cmath>
#include <optional>

#include "worker/light/light_sample.h"

namespace strata {

/// The same intensity in all directions (PBRT 12.2).
struct PointLight {
  Vec3f position;
  Rgb intensity;
};

/// Parallel light from infinitely far away (PBRT 12.3).
struct DistantLight {
  Vec3f direction;  ///< Unit, from the scene towards the light.
  Rgb irradiance;   ///< On a surface that faces it.
};

inline Rgb Intensity(const PointLight& light, Vec3f /*w*/) { return light.intensity; }

/// SampleLi of a light at a point, whose intensity depends on the direction.
template <typename X>
std::optional<LightSample> SampleFromPoint(const X& light, Vec3f from) {
  const Vec3f to_light = light.position - from;
  const float distance2 = LengthSquared(to_light);
  if (!(distance2 > 0)) return std::nullopt;
  LightSample sample;
  sample.wi = to_light / std::sqrt(distance2);
  sample.radiance = Intensity(light, -sample.wi) / distance2;
  if (IsBlack(sample.radiance)) return std::nullopt;
  sample.pdf = 1;
  sample.delta = true;
  sample.end = light.position;
  return sample;
}

inline std::optional<LightSample> SampleLi(const PointLight& light, Vec3f from, Vec2f /*u*/) {
  const Vec3f to_light = light.position - from;
  const float distance2 = LengthSquared(to_light);
  if (!(distance2 > 0)) return std::nullopt;
  LightSample sample;
  sample.wi = to_light / std::sqrt(distance2);
  sample.radiance = light.intensity / distance2;
  sample.pdf = 1;
  sample.delta = true;
  sample.end = light.position;
  return sample;
}

inline std::optional<LightSample> SampleLi(const DistantLight& light, Vec3f /*from*/, Vec2f /*u*/) {
  LightSample sample;
  sample.wi = light.direction;
  sample.radiance = light.irradiance;
  sample.pdf = 1;
  sample.delta = true;
  sample.infinite = true;
  return sample;
}

}  // namespace strata
