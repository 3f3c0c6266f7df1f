#include <algorithm>

#include "worker/geometry/surfaces.h"
#include "worker/math/elementary.h"

namespace strata {

CylinderSurface::CylinderSurface(const CylinderShape& shape)
    : radius(shape.radius),
      z_min(std::min(shape.z_min, shape.z_max)),
      z_max(std::max(shape.z_min, shape.z_max)),
      wedge(Wedge::FromDegrees(shape.phi_max)) {}

std::optional<SurfaceHit> Intersect(const CylinderSurface& cylinder, const SurfaceRay& ray) {
  // As for the sphere, in the plane across the axis.
  const Vec3d o = {ray.origin.x, ray.origin.y, 0}, d = {ray.direction.x, ray.direction.y, 0};
  const double inverse = 1 / Dot(d, d);
  const double t_nearest = -Dot(o, d) * inverse;
  const Vec3d nearest = o + d * t_nearest;
  const double half_chord2 = cylinder.radius * cylinder.radius - Dot(nearest, nearest);
  if (!(half_chord2 >= 0)) return std::nullopt;  // NaN: along the axis.
  const double half_chord = std::sqrt(half_chord2 * inverse);
  for (const double t : {t_nearest - half_chord, t_nearest + half_chord}) {
    if (!(t > ray.t_min && t < ray.t_max)) continue;
    const Vec3d p = ray.origin + ray.direction * t;
    if (p.z < cylinder.z_min || p.z > cylinder.z_max) continue;
    if (!cylinder.wedge.Contains(p.x, p.y)) continue;
    return SurfaceHit{t, p};
  }
  return std::nullopt;
}

LocalPoint PointAt(const CylinderSurface& cylinder, const SurfaceHit& hit) {
  LocalPoint point;
  point.ng = point.ns = Normalize(Vec3d{hit.p.x, hit.p.y, 0});
  point.p = point.ng * cylinder.radius;
  point.p.z = hit.p.z;
  point.dpdu = Vec3d{-point.p.y, point.p.x, 0} * cylinder.wedge.phi_max;
  point.uv = {cylinder.wedge.Fraction(point.p.x, point.p.y),
              std::clamp((hit.p.z - cylinder.z_min) / (cylinder.z_max - cylinder.z_min), 0.0, 1.0)};
  return point;
}

LocalDerivatives DerivativesAt(const CylinderSurface& cylinder, const SurfaceHit& hit) {
  LocalDerivatives d;
  d.dpdu = PointAt(cylinder, hit).dpdu;
  d.dpdv = {0, 0, cylinder.z_max - cylinder.z_min};
  d.dndu = d.dpdu * (1 / cylinder.radius);
  return d;
}

LocalPoint SampleArea(const CylinderSurface& cylinder, Vec2d u) {
  const double z = cylinder.z_min + u.x * (cylinder.z_max - cylinder.z_min);
  const SinCosResult<double> phi = SinCos(u.y * cylinder.wedge.phi_max);
  return PointAt(cylinder, {0, {cylinder.radius * phi.cos, cylinder.radius * phi.sin, z}});
}

double PdfArea(const CylinderSurface& cylinder, Vec3d /*p*/) {
  return 1 / (cylinder.wedge.phi_max * cylinder.radius * (cylinder.z_max - cylinder.z_min));
}

Vec3d NormalAt(const CylinderSurface& /*cylinder*/, Vec3d p) {
  return Normalize(Vec3d{p.x, p.y, 0});
}

Box BoundsOf(const CylinderSurface& cylinder) {
  return {{-cylinder.radius, -cylinder.radius, cylinder.z_min},
          {cylinder.radius, cylinder.radius, cylinder.z_max}};
}

}  // namespace strata
