#pragma once

#include <numbers>
#include <optional>

#include "worker/geometry/geometry.h"
#include "worker/light/light_sample.h"
#include "worker/sampling/spherical_triangle.h"
#include "worker/sampling/warp.h"

namespace strata {

/// A triangle that emits the same radiance from every point (PBRT 12.4), sampled uniformly by the
/// solid angle it fills where it is near (PBRT 6.5.4), by area where it is not.
struct TriangleLight {
  Vec3f p0, edge1, edge2;
  Vec3f ng;          ///< Unit, of the emitting side.
  float offset = 0;  ///< OffsetDistance of any sampled point.
  float pdf_area = 0;
  Rgb radiance;
  bool two_sided = false;
  float near2 = 0;  ///< Squared distance of the centroid below which it is near; 0: never.
};

/// Radiance that leaves the surface with outer normal `ng` towards `wo`.
inline Rgb Le(const TriangleLight& light, Vec3f ng, Vec3f wo) {
  return light.two_sided || Dot(ng, wo) > 0 ? light.radiance : Rgb{};
}

/// Density per solid angle of the direction to a point chosen with density `pdf_area`; 0 edge-on.
inline float AreaToSolidAngle(float pdf_area, Vec3f ng, Vec3f wi, float distance2) {
  const float cosine = AbsDot(ng, wi);
  return cosine > 0 ? pdf_area * distance2 / cosine : 0;
}

namespace triangle_light_detail {

inline bool IsNear(const TriangleLight& light, Vec3f from) {
  const Vec3f to_centroid = light.p0 + (light.edge1 + light.edge2) * (1.0f / 3) - from;
  return LengthSquared(to_centroid) < light.near2;
}

/// The triangle from where it is sampled by solid angle: nearby, but not where it is seen edge-on
/// or is the very surface the point lies on (less than 2 pi by this many steradians).
inline std::optional<SphericalTriangle> SeenFrom(const TriangleLight& light, Vec3f from) {
  constexpr double kMargin = 1e-4;
  if (!IsNear(light, from)) return std::nullopt;
  const SphericalTriangle triangle(light.p0, light.p0 + light.edge1, light.p0 + light.edge2, from);
  const double solid_angle = triangle.solid_angle();
  if (!(solid_angle > kMargin && solid_angle < 2 * std::numbers::pi - kMargin)) return std::nullopt;
  return triangle;
}

}  // namespace triangle_light_detail

inline float PdfLi(const TriangleLight& light, Vec3f from, const EmissionHit& hit) {
  if (const auto triangle = triangle_light_detail::SeenFrom(light, from)) return triangle->Pdf();
  return AreaToSolidAngle(light.pdf_area, hit.ng, hit.wi, hit.distance * hit.distance);
}

inline std::optional<LightSample> SampleLi(const TriangleLight& light, Vec3f from, Vec2f u) {
  LightSample sample;
  const std::optional<SphericalTriangle> near = triangle_light_detail::SeenFrom(light, from);
  const Vec2f b = near ? near->WeightsOf(near->Sample(u)) : SampleTriangle(u);
  const Vec3f p = light.p0 + Fma(light.edge1, b.x, light.edge2 * b.y);
  const Vec3f to_light = p - from;
  const float distance2 = LengthSquared(to_light);
  if (!(distance2 > 0)) return std::nullopt;
  sample.wi = to_light / std::sqrt(distance2);
  sample.radiance = Le(light, light.ng, -sample.wi);
  sample.pdf =
      near ? near->Pdf() : AreaToSolidAngle(light.pdf_area, light.ng, sample.wi, distance2);
  if (!(sample.pdf > 0) || IsBlack(sample.radiance)) return std::nullopt;
  sample.end = OffsetRayOrigin(p, light.offset, light.ng, -to_light);
  return sample;
}

}  // namespace strata
