#pragma once

#include <cmath>
#include <optional>

#include "worker/geometry/geometry.h"
#include "worker/light/light_sample.h"
#include "worker/light/triangle_light.h"
#include "worker/math/elementary.h"

namespace strata {

/// A parallelogram that emits the same radiance from every point: two triangles of a mesh as one
/// light. A rectangle that is near is sampled uniformly by the solid angle it fills (Urena, Fajardo
/// and King 2013), anything else uniformly by area.
struct QuadLight {
  Vec3f corner, edge1, edge2;
  Vec3f ng;       ///< Unit, of the emitting side.
  Vec3f p_error;  ///< Bounds the rounding error of any sampled point (PBRT 6.8.5).
  float pdf_area = 0;
  Rgb radiance;
  bool two_sided = false;
  Vec3f unit1, unit2;  ///< Along the edges.
  float length1 = 0, length2 = 0;
  float near2 = 0;  ///< Squared distance of the centre below which it is near; 0: never.
};

inline Rgb Le(const QuadLight& light, Vec3f ng, Vec3f wo) {
  return light.two_sided || Dot(ng, wo) > 0 ? light.radiance : Rgb{};
}

/// A rectangle as it is seen from a point, which is the origin of its coordinates here: x and y
/// along the edges, z towards the point.
struct SphericalRectangle {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0, z0 = 0;  ///< Of the corners; z0 is negative.
  float b0 = 0, b1 = 0, k = 0;
  float solid_angle = 0;  ///< Within 1e-6; 0 or less: the point lies in the rectangle's plane.

  SphericalRectangle(const QuadLight& light, Vec3f from) {
    const Vec3f d = light.corner - from;
    z0 = -AbsDot(d, light.ng);
    x0 = Dot(d, light.unit1);
    y0 = Dot(d, light.unit2);
    x1 = x0 + light.length1;
    y1 = y0 + light.length2;
    // The angles between the planes through the point and the edges add up to 2 pi and the solid
    // angle.
    const float zz = z0 * z0;
    if (!(zz > 0)) return;
    const auto slope = [zz](float c) { return c / std::sqrt(zz + c * c); };
    const float n0 = -slope(y0), n1 = slope(x1), n2 = slope(y1), n3 = -slope(x0);
    k = 2 * kPi - Acos(-n2 * n3) - Acos(-n3 * n0);
    b0 = n0;
    b1 = n2;
    solid_angle = Acos(-n0 * n1) + Acos(-n1 * n2) - k;
  }

  /// A point of the rectangle, in parts of its edges.
  Vec2f Sample(Vec2f u) const {
    constexpr float kTiny = 1e-12f;
    const SinCosResult<float> angle = SinCos(u.x * solid_angle + k);
    const float f = (angle.cos * b0 - b1) / angle.sin;
    const float c = std::copysign(1 / std::sqrt(f * f + b0 * b0), f);
    const float x = std::clamp(-(c * z0) / std::sqrt(std::max(1 - c * c, kTiny)), x0, x1);
    const float d2 = x * x + z0 * z0;
    const float h0 = y0 / std::sqrt(d2 + y0 * y0), h1 = y1 / std::sqrt(d2 + y1 * y1);
    const float h = h0 + u.y * (h1 - h0);
    const float y = std::clamp(h * std::sqrt(d2 / std::max(1 - h * h, kTiny)), y0, y1);
    return {(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)};
  }
};

namespace quad_light_detail {

inline bool IsNear(const QuadLight& light, Vec3f from) {
  const Vec3f to_center = light.corner + (light.edge1 + light.edge2) * 0.5f - from;
  return LengthSquared(to_center) < light.near2;
}

}  // namespace quad_light_detail

inline float PdfLi(const QuadLight& light, Vec3f from, const EmissionHit& hit) {
  if (quad_light_detail::IsNear(light, from)) {
    const SphericalRectangle rectangle(light, from);
    return rectangle.solid_angle > 0 ? 1 / rectangle.solid_angle : 0;
  }
  return AreaToSolidAngle(light.pdf_area, hit.ng, hit.wi, hit.distance * hit.distance);
}

inline std::optional<LightSample> SampleLi(const QuadLight& light, Vec3f from, Vec2f u) {
  LightSample sample;
  if (quad_light_detail::IsNear(light, from)) {
    const SphericalRectangle rectangle(light, from);
    if (!(rectangle.solid_angle > 0)) return std::nullopt;
    u = rectangle.Sample(u);
    sample.pdf = 1 / rectangle.solid_angle;
  }
  const Vec3f p = light.corner + (light.edge1 * u.x + light.edge2 * u.y);
  const Vec3f to_light = p - from;
  const float distance2 = LengthSquared(to_light);
  if (!(distance2 > 0)) return std::nullopt;
  sample.wi = to_light / std::sqrt(distance2);
  sample.radiance = Le(light, light.ng, -sample.wi);
  if (sample.pdf == 0)
    sample.pdf = AreaToSolidAngle(light.pdf_area, light.ng, sample.wi, distance2);
  if (!(sample.pdf > 0) || IsBlack(sample.radiance)) return std::nullopt;
  sample.end = OffsetRayOrigin(p, light.p_error, light.ng, -to_light);
  return sample;
}

}  // namespace strata
