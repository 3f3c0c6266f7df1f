#pragma once

#include <optional>

#include "worker/geometry/geometry.h"
#include "worker/light/light_sample.h"
#include "worker/light/triangle_light.h"
#include "worker/sampling/warp.h"

namespace strata {

/// A full sphere that emits the same radiance from every point. From outside it is sampled
/// uniformly in the cone it fills (PBRT 6.2.4), from inside uniformly by area.
struct SphereLight {
  Vec3f center;
  float radius = 0;
  bool inward = false;  ///< The emitting side is the inside.
  Rgb radiance;
  bool two_sided = false;
  bool cone = true;  ///< false, to compare with: by area from outside too.
};

inline Rgb Le(const SphereLight& light, Vec3f ng, Vec3f wo) {
  return light.two_sided || Dot(ng, wo) > 0 ? light.radiance : Rgb{};
}

namespace sphere_light_detail {

/// OffsetDistance of a point that is computed as center + n * radius.
inline float PointOffset(const SphereLight& light, Vec3f n) {
  return Dot(Abs(n), Abs(light.center) + Abs(n) * light.radius) * Gamma(9);
}

/// A point on the sphere may round to either side of it, so the cone keeps a distance from points
/// that the inside lights.
inline bool IsSampledByArea(const SphereLight& light, float distance2) {
  if (!light.cone || (light.inward && !light.two_sided)) return true;
  const float margin = light.two_sided ? 1.001f : 1;
  return distance2 <= light.radius * light.radius * margin;
}

inline float PdfArea(const SphereLight& light) {
  return 1 / (4 * kPi * light.radius * light.radius);
}

/// `n` points away from the center.
inline Vec3f OuterNormal(const SphereLight& light, Vec3f n) { return light.inward ? -n : n; }

inline std::optional<LightSample> SampleByArea(const SphereLight& light, Vec3f from, Vec2f u) {
  const Vec3f n = SampleUniformSphere(u);
  const Vec3f p = light.center + n * light.radius;
  const Vec3f to_light = p - from;
  const float distance2 = LengthSquared(to_light);
  if (!(distance2 > 0)) return std::nullopt;
  LightSample sample;
  sample.wi = to_light / std::sqrt(distance2);
  const Vec3f ng = OuterNormal(light, n);
  sample.radiance = Le(light, ng, -sample.wi);
  sample.pdf = AreaToSolidAngle(PdfArea(light), ng, sample.wi, distance2);
  if (!(sample.pdf > 0) || IsBlack(sample.radiance)) return std::nullopt;
  sample.end = OffsetRayOrigin(p, PointOffset(light, n), n, -to_light);
  return sample;
}

}  // namespace sphere_light_detail

inline float PdfLi(const SphereLight& light, Vec3f from, const EmissionHit& hit) {
  const float distance2 = LengthSquared(light.center - from);
  const float radius2 = light.radius * light.radius;
  if (sphere_light_detail::IsSampledByArea(light, distance2))
    return AreaToSolidAngle(sphere_light_detail::PdfArea(light), hit.ng, hit.wi,
                            hit.distance * hit.distance);
  return UniformConePdf(OneMinusCosFromSinSquared(radius2 / distance2));
}

inline std::optional<LightSample> SampleLi(const SphereLight& light, Vec3f from, Vec2f u) {
  const Vec3f to_center = light.center - from;
  const float distance2 = LengthSquared(to_center);
  const float radius2 = light.radius * light.radius;
  if (sphere_light_detail::IsSampledByArea(light, distance2))
    return sphere_light_detail::SampleByArea(light, from, u);

  const float one_minus_cos_max = OneMinusCosFromSinSquared(radius2 / distance2);
  const Vec3f local = SampleUniformCone(u, one_minus_cos_max);
  const float distance = std::sqrt(distance2);
  LightSample sample;
  sample.wi = Frame::FromNormal(to_center / distance).ToWorld(local);
  sample.pdf = UniformConePdf(one_minus_cos_max);
  // The nearer of the two points where the ray meets the sphere.
  const float sin2 = local.x * local.x + local.y * local.y;
  const float half_chord = std::sqrt(std::max(0.0f, radius2 - distance2 * sin2));
  const Vec3f n = Normalize(sample.wi * (distance * local.z - half_chord) - to_center);
  // From outside the emitting side alone is seen. Its normal would not tell: for a small sphere
  // the rounding of the direction moves the point by a part of the radius.
  sample.radiance = light.radiance;
  const Vec3f p = light.center + n * light.radius;
  sample.end = OffsetRayOrigin(p, sphere_light_detail::PointOffset(light, n), n, -sample.wi);
  return sample;
}

}  // namespace strata
