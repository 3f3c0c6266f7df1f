#include <algorithm>

#include "worker/geometry/surfaces.h"
#include "worker/math/elementary.h"

namespace strata {

DiskSurface::DiskSurface(const DiskShape& shape)
    : height(shape.height),
      radius(shape.radius),
      inner_radius(std::max(0.0f, shape.inner_radius)),
      wedge(Wedge::FromDegrees(shape.phi_max)) {}

std::optional<SurfaceHit> Intersect(const DiskSurface& disk, const SurfaceRay& ray) {
  const double t = (disk.height - ray.origin.z) / ray.direction.z;
  if (!(t > ray.t_min && t < ray.t_max)) return std::nullopt;  // NaN and infinity: parallel.
  const double x = ray.origin.x + ray.direction.x * t;
  const double y = ray.origin.y + ray.direction.y * t;
  const double r2 = x * x + y * y;
  if (!(r2 <= disk.radius * disk.radius && r2 >= disk.inner_radius * disk.inner_radius))
    return std::nullopt;
  if (!disk.wedge.Contains(x, y)) return std::nullopt;
  return SurfaceHit{t, {x, y, disk.height}};
}

LocalPoint PointAt(const DiskSurface& disk, const SurfaceHit& hit) {
  LocalPoint point;
  point.p = {hit.p.x, hit.p.y, disk.height};
  point.ng = point.ns = {0, 0, 1};
  point.dpdu = Vec3d{-point.p.y, point.p.x, 0} * disk.wedge.phi_max;
  const double r = std::sqrt(point.p.x * point.p.x + point.p.y * point.p.y);
  point.uv = {disk.wedge.Fraction(point.p.x, point.p.y),
              std::clamp((disk.radius - r) / (disk.radius - disk.inner_radius), 0.0, 1.0)};
  return point;
}

LocalDerivatives DerivativesAt(const DiskSurface& disk, const SurfaceHit& hit) {
  const LocalPoint point = PointAt(disk, hit);
  const double r = std::sqrt(point.p.x * point.p.x + point.p.y * point.p.y);
  LocalDerivatives d;
  d.dpdu = point.dpdu;
  if (r > 0) d.dpdv = Vec3d{point.p.x, point.p.y, 0} * ((disk.inner_radius - disk.radius) / r);
  return d;
}

LocalPoint SampleArea(const DiskSurface& disk, Vec2d u) {
  const double inner2 = disk.inner_radius * disk.inner_radius;
  const double r = std::sqrt(inner2 + u.x * (disk.radius * disk.radius - inner2));
  const SinCosResult<double> phi = SinCos(u.y * disk.wedge.phi_max);
  return PointAt(disk, {0, {r * phi.cos, r * phi.sin, disk.height}});
}

double PdfArea(const DiskSurface& disk, Vec3d /*p*/) {
  return 2 /
         (disk.wedge.phi_max * (disk.radius * disk.radius - disk.inner_radius * disk.inner_radius));
}

Vec3d NormalAt(const DiskSurface& /*disk*/, Vec3d /*p*/) { return {0, 0, 1}; }

Box BoundsOf(const DiskSurface& disk) {
  return {{-disk.radius, -disk.radius, disk.height}, {disk.radius, disk.radius, disk.height}};
}

}  // namespace strata
