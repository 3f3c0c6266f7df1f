#pragma once

#include <limits>
#include <optional>
#include <variant>

#include "worker/math/box.h"
#include "worker/math/vec3d.h"
#include "worker/scene/description.h"

// Curved surfaces in their own space, in double. Each kind is a plain struct, made from its
// description, with free functions:
//
//   std::optional<SurfaceHit> Intersect(const X&, const SurfaceRay&)   nearest in (t_min, t_max)
//   LocalPoint PointAt(const X&, const SurfaceHit&)           the hit moved onto the surface
//   LocalDerivatives DerivativesAt(const X&, const SurfaceHit&)
//   LocalPoint SampleArea(const X&, Vec2d u)                  u in [0,1)^2
//   double PdfArea(const X&, Vec3d p)                         per unit of area, at p on it
//   Vec3d NormalAt(const X&, Vec3d p)                         unit, at p on it
//   Box BoundsOf(const X&)
//
// Normals are the cross product of dp/du and dp/dv, as pbrt's. (PBRT 6.2 to 6.6.)

namespace strata {

struct Vec2d {
  double x = 0, y = 0;
};

struct SurfaceRay {
  Vec3d origin, direction;  ///< The direction need not be of unit length.
  double t_max = std::numeric_limits<double>::infinity();
  double t_min = 0;
};

struct SurfaceHit {
  double t = 0;
  Vec3d p;
  double u = 0, v = 0;  ///< Parameters of a bilinear patch; unused by the others.
};

struct LocalPoint {
  Vec3d p;
  Vec3d ng;  ///< Unit.
  Vec3d ns;  ///< Unit; ng where the surface has no other.
  Vec3d dpdu;
  Vec2d uv;
};

/// How the point and the shading normal of a LocalPoint move with its (u, v).
struct LocalDerivatives {
  Vec3d dpdu, dpdv, dndu, dndv;
};

/// The angles [0, phi_max] around z, tested without an arc tangent.
struct Wedge {
  double phi_max = 0;       ///< Radians.
  double sin = 0, cos = 1;  ///< Of phi_max.
  bool reflex = true;       ///< More than half a turn.
  bool full = true;

  static Wedge FromDegrees(double degrees);
  bool Contains(double x, double y) const {
    if (full) return true;
    const bool before_end = cos * y - sin * x <= 0;  // Clockwise of the ray at phi_max.
    return reflex ? y >= 0 || before_end : y >= 0 && before_end;
  }
  /// The angle of (x, y) in [0, 1] of phi_max.
  double Fraction(double x, double y) const;
};

struct SphereSurface {
  double radius = 1, z_min = -1, z_max = 1;
  double theta_min = 0, theta_max = 0;  ///< Polar angles at z_min and z_max: theta_min is larger.
  Wedge wedge;

  bool IsFull() const { return wedge.full && z_min <= -radius && z_max >= radius; }
  explicit SphereSurface(const SphereShape& shape);
};

struct DiskSurface {
  double height = 0, radius = 1, inner_radius = 0;
  Wedge wedge;

  explicit DiskSurface(const DiskShape& shape);
};

struct CylinderSurface {
  double radius = 1, z_min = -1, z_max = 1;
  Wedge wedge;

  explicit CylinderSurface(const CylinderShape& shape);
};

/// p(u, v) = (1-v) ((1-u) p00 + u p10) + v ((1-u) p01 + u p11).
struct BilinearPatchSurface {
  Vec3d p[4];  ///< p00, p10, p01, p11.
  Vec3d n[4];  ///< Vertex normals, on the outer side; used if has_normals.
  Vec2d uv[4] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
  bool has_normals = false;

  Vec3d PointAt(double u, double v) const {
    return Lerp(v, Lerp(u, p[0], p[1]), Lerp(u, p[2], p[3]));
  }
  Vec3d DpDu(double v) const { return Lerp(v, p[1] - p[0], p[3] - p[2]); }
  Vec3d DpDv(double u) const { return Lerp(u, p[2] - p[0], p[3] - p[1]); }
};

using CurvedSurface =
    std::variant<SphereSurface, DiskSurface, CylinderSurface, BilinearPatchSurface>;

std::optional<SurfaceHit> Intersect(const SphereSurface& sphere, const SurfaceRay& ray);
LocalPoint PointAt(const SphereSurface& sphere, const SurfaceHit& hit);
LocalDerivatives DerivativesAt(const SphereSurface& sphere, const SurfaceHit& hit);
LocalPoint SampleArea(const SphereSurface& sphere, Vec2d u);
double PdfArea(const SphereSurface& sphere, Vec3d p);
Vec3d NormalAt(const SphereSurface& sphere, Vec3d p);
Box BoundsOf(const SphereSurface& sphere);

std::optional<SurfaceHit> Intersect(const DiskSurface& disk, const SurfaceRay& ray);
LocalPoint PointAt(const DiskSurface& disk, const SurfaceHit& hit);
LocalDerivatives DerivativesAt(const DiskSurface& disk, const SurfaceHit& hit);
LocalPoint SampleArea(const DiskSurface& disk, Vec2d u);
double PdfArea(const DiskSurface& disk, Vec3d p);
Vec3d NormalAt(const DiskSurface& disk, Vec3d p);
Box BoundsOf(const DiskSurface& disk);

std::optional<SurfaceHit> Intersect(const CylinderSurface& cylinder, const SurfaceRay& ray);
LocalPoint PointAt(const CylinderSurface& cylinder, const SurfaceHit& hit);
LocalDerivatives DerivativesAt(const CylinderSurface& cylinder, const SurfaceHit& hit);
LocalPoint SampleArea(const CylinderSurface& cylinder, Vec2d u);
double PdfArea(const CylinderSurface& cylinder, Vec3d p);
Vec3d NormalAt(const CylinderSurface& cylinder, Vec3d p);
Box BoundsOf(const CylinderSurface& cylinder);

std::optional<SurfaceHit> Intersect(const BilinearPatchSurface& patch, const SurfaceRay& ray);
LocalPoint PointAt(const BilinearPatchSurface& patch, const SurfaceHit& hit);
LocalDerivatives DerivativesAt(const BilinearPatchSurface& patch, const SurfaceHit& hit);
LocalPoint SampleArea(const BilinearPatchSurface& patch, Vec2d u);
double PdfArea(const BilinearPatchSurface& patch, Vec3d p);
Vec3d NormalAt(const BilinearPatchSurface& patch, Vec3d p);
Box BoundsOf(const BilinearPatchSurface& patch);
/// (u, v) in [0, 1]^2 of a point on the patch, not those of its texture.
Vec2d ParametersOf(const BilinearPatchSurface& patch, Vec3d p);

}  // namespace strata
