#pragma once

#include <cmath>
#include <optional>

#include "worker/geometry/geometry.h"
#include "worker/light/light_sample.h"
#include "worker/light/triangle_light.h"
#include "worker/sampling/spherical_rectangle.h"

namespace strata {

/// A parallelogram that emits the same radiance from every point (PBRT 12.4): two triangles of a
/// mesh as one light. A rectangle that is near is sampled uniformly by the solid angle it fills
/// (PBRT 6.6.2), anything else uniformly by area.
struct QuadLight {
  Vec3f corner, edge1, edge2;
  Vec3f ng;          ///< Unit, of the emitting side.
  float offset = 0;  ///< OffsetDistance of any sampled point.
  float pdf_area = 0;
  Rgb radiance;
  bool two_sided = false;
  float scale1 = 0, scale2 = 0;  ///< The edges' RectangleScales.
  float near2 = 0;  ///< Squared distance of the centre below which it is near; 0: never.
};

inline Rgb Le(const QuadLight& light, Vec3f ng, Vec3f wo) {
  return light.two_sided || Dot(ng, wo) > 0 ? light.radiance : Rgb{};
}

namespace quad_light_detail {

inline bool IsNear(const QuadLight& light, Vec3f from) {
  const Vec3f to_center = light.corner + (light.edge1 + light.edge2) * 0.5f - from;
  return LengthSquared(to_center) < light.near2;
}

inline SphericalRectangle SeenFrom(const QuadLight& light, Vec3f from) {
  return {light.corner,
          light.edge1,
          light.scale1,
          light.edge2,
          light.scale2,
          light.ng,
          std::sqrt(light.pdf_area),
          from};
}

}  // namespace quad_light_detail

inline float PdfLi(const QuadLight& light, Vec3f from, const EmissionHit& hit) {
  if (quad_light_detail::IsNear(light, from)) {
    const SphericalRectangle rectangle = quad_light_detail::SeenFrom(light, from);
    return rectangle.solid_angle > 0 ? 1 / rectangle.solid_angle : 0;
  }
  return AreaToSolidAngle(light.pdf_area, hit.ng, hit.wi, hit.distance * hit.distance);
}

inline std::optional<LightSample> SampleLi(const QuadLight& light, Vec3f from, Vec2f u) {
  LightSample sample;
  if (quad_light_detail::IsNear(light, from)) {
    const SphericalRectangle rectangle = quad_light_detail::SeenFrom(light, from);
    if (!(rectangle.solid_angle > 0)) return std::nullopt;
    u = rectangle.Sample(u);
    sample.pdf = 1 / rectangle.solid_angle;
  }
  const Vec3f p = light.corner + Fma(light.edge1, u.x, light.edge2 * u.y);
  const Vec3f to_light = p - from;
  const float distance2 = LengthSquared(to_light);
  if (!(distance2 > 0)) return std::nullopt;
  sample.wi = to_light / std::sqrt(distance2);
  sample.radiance = Le(light, light.ng, -sample.wi);
  if (sample.pdf == 0)
    sample.pdf = AreaToSolidAngle(light.pdf_area, light.ng, sample.wi, distance2);
  if (!(sample.pdf > 0) || IsBlack(sample.radiance)) return std::nullopt;
  sample.end = OffsetRayOrigin(p, light.offset, light.ng, -to_light);
  return sample;
}

}  // namespace strata
