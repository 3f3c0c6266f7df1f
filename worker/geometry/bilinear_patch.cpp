#include <algorithm>
#include <array>
#include <cmath>

#include "worker/geometry/surfaces.h"

namespace strata {
namespace {

struct Root {
  double t = 0, u = 0, v = 0;
  double error = 0;  ///< By which t may be off, with a wide margin.
};

/// Where a line meets the patch continued beyond its edges, up to two points (Reshetov, Ray Tracing
/// Gems, chapter 8): u first, from a quadratic, then v and t on the segment of that u.
int LineRoots(const BilinearPatchSurface& patch, Vec3d origin, Vec3d direction, Root roots[2]) {
  const Vec3d p00 = patch.p[0], p10 = patch.p[1], p01 = patch.p[2], p11 = patch.p[3];
  const double a = Dot(Cross(p10 - p00, p01 - p11), direction);
  const double c = Dot(Cross(p00 - origin, direction), p01 - p00);
  const double b = Dot(Cross(p10 - origin, direction), p11 - p10) - (a + c);
  const double discriminant = b * b - 4 * a * c;
  if (!(discriminant >= 0)) return 0;
  // The stable pair of roots, which also serves parallelograms, where a vanishes.
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  int count = 0;
  for (const double u : {q / a, c / q}) {
    if (!std::isfinite(u)) continue;
    const Vec3d start = Lerp(u, p00, p10);
    const Vec3d along = Lerp(u, p01, p11) - start;
    const Vec3d across = Cross(direction, along);
    const double across2 = Dot(across, across);
    if (!(across2 > 0)) continue;
    const Vec3d delta = start - origin;
    constexpr double kDoubleError = 0x1p-48;
    const double size = Length(start) + Length(origin) + Length(along);
    roots[count++] = {Dot(delta, Cross(along, across)) / across2, u,
                      Dot(delta, Cross(direction, across)) / across2,
                      kDoubleError * size * std::sqrt(Dot(along, along) / across2)};
  }
  return count;
}

/// The texture coordinates (s, t) by the parameters (u, v).
struct UvJacobian {
  double dsdu, dsdv, dtdu, dtdv, determinant;

  UvJacobian(const BilinearPatchSurface& patch, double u, double v) {
    const auto& uv = patch.uv;
    dsdu = (1 - v) * (uv[1].x - uv[0].x) + v * (uv[3].x - uv[2].x);
    dsdv = (1 - u) * (uv[2].x - uv[0].x) + u * (uv[3].x - uv[1].x);
    dtdu = (1 - v) * (uv[1].y - uv[0].y) + v * (uv[3].y - uv[2].y);
    dtdv = (1 - u) * (uv[2].y - uv[0].y) + u * (uv[3].y - uv[1].y);
    determinant = dsdu * dtdv - dsdv * dtdu;
  }
  /// The derivatives by s and by t of what has these by u and v; those themselves where (s, t) do
  /// not determine a place.
  Vec3d AlongU(Vec3d du, Vec3d dv) const {
    return determinant == 0 ? du : (du * dtdv - dv * dtdu) * (1 / determinant);
  }
  Vec3d AlongV(Vec3d du, Vec3d dv) const {
    return determinant == 0 ? dv : (dv * dsdu - du * dsdv) * (1 / determinant);
  }
};

/// Area per unit of (u, v) at the corners; between them it is about bilinear.
std::array<double, 4> CornerWeights(const BilinearPatchSurface& patch) {
  const auto weight = [&](double u, double v) {
    return Length(Cross(patch.DpDu(v), patch.DpDv(u)));
  };
  return {weight(0, 0), weight(1, 0), weight(0, 1), weight(1, 1)};
}

/// x in [0, 1] with the density (1-x) a + x b, normalized.
double SampleLinear(double u, double a, double b) {
  if (!(a + b > 0)) return u;
  const double root = std::sqrt((1 - u) * a * a + u * b * b);
  if (!(a + root > 0)) return 0;
  return std::min(u * (a + b) / (a + root), 1.0);
}

}  // namespace

std::optional<SurfaceHit> Intersect(const BilinearPatchSurface& patch, const SurfaceRay& ray) {
  Root roots[2];
  const int count = LineRoots(patch, ray.origin, ray.direction, roots);
  std::optional<SurfaceHit> nearest;
  for (int i = 0; i < count; ++i) {
    const auto [t, u, v, error] = roots[i];
    // Rays that leave a patch in a plane where a coordinate is 0 begin exactly on it.
    const double t_min = ray.t_min + error;
    if (!(u >= 0 && u <= 1 && v >= 0 && v <= 1 && t > t_min && t < ray.t_max)) continue;
    if (!nearest || t < nearest->t) nearest = SurfaceHit{t, patch.PointAt(u, v), u, v};
  }
  return nearest;
}

LocalPoint PointAt(const BilinearPatchSurface& patch, const SurfaceHit& hit) {
  const double u = hit.u, v = hit.v;
  LocalPoint point;
  point.p = patch.PointAt(u, v);
  Vec3d dpdu = patch.DpDu(v), dpdv = patch.DpDv(u);
  // At a corner that two edges share the tangent plane is that of the nearby inside.
  Vec3d cross = Cross(dpdu, dpdv);
  if (!(Dot(cross, cross) > 0))
    cross = Cross(patch.DpDu(v + (0.5 - v) * 1e-4), patch.DpDv(u + (0.5 - u) * 1e-4));
  point.ng = Normalize(cross);

  const auto interpolate = [&](double a, double b, double c, double d) {
    return (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * c + u * d);
  };
  const auto& uv = patch.uv;
  point.uv = {interpolate(uv[0].x, uv[1].x, uv[2].x, uv[3].x),
              interpolate(uv[0].y, uv[1].y, uv[2].y, uv[3].y)};
  point.dpdu = UvJacobian(patch, u, v).AlongU(dpdu, dpdv);

  point.ns = point.ng;
  if (patch.has_normals) {
    const Vec3d ns = Lerp(v, Lerp(u, patch.n[0], patch.n[1]), Lerp(u, patch.n[2], patch.n[3]));
    if (Dot(ns, ns) > 1e-8) point.ns = Normalize(ns);
  }
  return point;
}

/// How the normal turns is known of vertex normals alone; the patch's own twist counts as none.
LocalDerivatives DerivativesAt(const BilinearPatchSurface& patch, const SurfaceHit& hit) {
  const double u = hit.u, v = hit.v;
  const UvJacobian uvs(patch, u, v);
  const Vec3d dpdu = patch.DpDu(v), dpdv = patch.DpDv(u);
  LocalDerivatives d;
  d.dpdu = uvs.AlongU(dpdu, dpdv);
  d.dpdv = uvs.AlongV(dpdu, dpdv);
  if (!patch.has_normals) return d;
  const Vec3d* n = patch.n;
  const Vec3d ns = Lerp(v, Lerp(u, n[0], n[1]), Lerp(u, n[2], n[3]));
  const double length2 = Dot(ns, ns);
  if (!(length2 > 1e-8)) return d;
  const Vec3d dndu = Lerp(v, n[1] - n[0], n[3] - n[2]), dndv = Lerp(u, n[2] - n[0], n[3] - n[1]);
  // Of the unit vector along ns.
  const auto turn = [&](Vec3d dn) {
    return (dn - ns * (Dot(ns, dn) / length2)) * (1 / std::sqrt(length2));
  };
  d.dndu = turn(uvs.AlongU(dndu, dndv));
  d.dndv = turn(uvs.AlongV(dndu, dndv));
  return d;
}

LocalPoint SampleArea(const BilinearPatchSurface& patch, Vec2d sample) {
  const std::array<double, 4> w = CornerWeights(patch);
  const double v = SampleLinear(sample.y, w[0] + w[1], w[2] + w[3]);
  const double u = SampleLinear(sample.x, (1 - v) * w[0] + v * w[2], (1 - v) * w[1] + v * w[3]);
  return PointAt(patch, {0, {}, u, v});
}

Vec2d ParametersOf(const BilinearPatchSurface& patch, Vec3d p) {
  // Of the places where the line through p along the mean normal meets the patch, the one nearest
  // to p.
  const Vec3d across = Cross(patch.p[3] - patch.p[0], patch.p[2] - patch.p[1]);
  Root roots[2];
  const int count = LineRoots(patch, p, across, roots);
  if (count == 0) return {0.5, 0.5};
  const bool second = count == 2 && std::abs(roots[1].t) < std::abs(roots[0].t);
  const Root& root = roots[second];
  return {std::clamp(root.u, 0.0, 1.0), std::clamp(root.v, 0.0, 1.0)};
}

double PdfArea(const BilinearPatchSurface& patch, Vec3d p) {
  const auto [u, v] = ParametersOf(patch, p);
  const std::array<double, 4> w = CornerWeights(patch);
  const double density = (1 - v) * ((1 - u) * w[0] + u * w[1]) + v * ((1 - u) * w[2] + u * w[3]);
  const double stretch = Length(Cross(patch.DpDu(v), patch.DpDv(u)));
  return density / (0.25 * (w[0] + w[1] + w[2] + w[3]) * stretch);
}

Vec3d NormalAt(const BilinearPatchSurface& patch, Vec3d p) {
  const Vec2d uv = ParametersOf(patch, p);
  return Normalize(Cross(patch.DpDu(uv.y), patch.DpDv(uv.x)));
}

Box BoundsOf(const BilinearPatchSurface& patch) {
  Box box;
  for (const Vec3d& corner : patch.p) box.Include(corner);
  return box;
}

}  // namespace strata
