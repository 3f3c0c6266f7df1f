#include <algorithm>
#include <numbers>

#include "worker/geometry/surfaces.h"
#include "worker/math/elementary.h"

namespace strata {

SphereSurface::SphereSurface(const SphereShape& shape)
    : radius(shape.radius), wedge(Wedge::FromDegrees(shape.phi_max)) {
  z_min = std::clamp<double>(std::min(shape.z_min, shape.z_max), -radius, radius);
  z_max = std::clamp<double>(std::max(shape.z_min, shape.z_max), -radius, radius);
  theta_min = Acos(z_min / radius);
  theta_max = Acos(z_max / radius);
}

std::optional<SurfaceHit> Intersect(const SphereSurface& sphere, const SurfaceRay& ray) {
  // From the point of the ray nearest to the center, so that a far origin costs no digits (Haines
  // et al., Ray Tracing Gems, chapter 7).
  const double inverse = 1 / Dot(ray.direction, ray.direction);
  const double t_nearest = -Dot(ray.origin, ray.direction) * inverse;
  const Vec3d nearest = ray.origin + ray.direction * t_nearest;
  const double half_chord2 = sphere.radius * sphere.radius - Dot(nearest, nearest);
  if (!(half_chord2 >= 0)) return std::nullopt;
  const double half_chord = std::sqrt(half_chord2 * inverse);
  for (const double t : {t_nearest - half_chord, t_nearest + half_chord}) {
    if (!(t > ray.t_min && t < ray.t_max)) continue;
    const Vec3d p = ray.origin + ray.direction * t;
    // A full sphere ends where rounding puts p, not at z_min and z_max.
    if (!sphere.IsFull() &&
        ((sphere.z_min > -sphere.radius && p.z < sphere.z_min) ||
         (sphere.z_max < sphere.radius && p.z > sphere.z_max) || !sphere.wedge.Contains(p.x, p.y)))
      continue;
    return SurfaceHit{t, p};
  }
  return std::nullopt;
}

LocalPoint PointAt(const SphereSurface& sphere, const SurfaceHit& hit) {
  LocalPoint point;
  point.ng = point.ns = Normalize(hit.p);
  point.p = point.ng * sphere.radius;
  point.dpdu = Vec3d{-point.p.y, point.p.x, 0} * sphere.wedge.phi_max;
  const double theta = Acos(static_cast<float>(point.ng.z));
  point.uv = {
      sphere.wedge.Fraction(point.p.x, point.p.y),
      std::clamp((theta - sphere.theta_min) / (sphere.theta_max - sphere.theta_min), 0.0, 1.0)};
  return point;
}

LocalDerivatives DerivativesAt(const SphereSurface& sphere, const SurfaceHit& hit) {
  const LocalPoint point = PointAt(sphere, hit);
  const Vec3d p = point.p;
  const double r = std::sqrt(p.x * p.x + p.y * p.y);
  LocalDerivatives d;
  d.dpdu = point.dpdu;
  // None at the poles, where u has no direction either.
  if (r > 0)
    d.dpdv = Vec3d{p.z * p.x / r, p.z * p.y / r, -r} * (sphere.theta_max - sphere.theta_min);
  d.dndu = d.dpdu * (1 / sphere.radius);
  d.dndv = d.dpdv * (1 / sphere.radius);
  return d;
}

LocalPoint SampleArea(const SphereSurface& sphere, Vec2d u) {
  // Archimedes: equal heights have equal areas.
  const double z = sphere.z_min + u.x * (sphere.z_max - sphere.z_min);
  const SinCosResult<double> phi = SinCos(u.y * sphere.wedge.phi_max);
  const double r = std::sqrt(std::max(0.0, sphere.radius * sphere.radius - z * z));
  return PointAt(sphere, {0, {r * phi.cos, r * phi.sin, z}});
}

double PdfArea(const SphereSurface& sphere, Vec3d /*p*/) {
  return 1 / (sphere.wedge.phi_max * sphere.radius * (sphere.z_max - sphere.z_min));
}

Vec3d NormalAt(const SphereSurface& /*sphere*/, Vec3d p) { return Normalize(p); }

Box BoundsOf(const SphereSurface& sphere) {
  return {{-sphere.radius, -sphere.radius, sphere.z_min},
          {sphere.radius, sphere.radius, sphere.z_max}};
}

}  // namespace strata
