#include "worker/geometry/curved_shape.h"

#include <cmath>
#include <type_traits>
#include <variant>

#include "worker/geometry/rounding.h"

namespace strata {
namespace {

struct RoundedPoint {
  Vec3f p, p_error;
};

/// The point in the group's space, rounded to float once; what the doubles before it may err by is
/// bounded with a wide margin.
RoundedPoint ToGroup(const Placement& placement, Vec3d p) {
  constexpr double kDoubleError = 0x1p-46;
  RoundedPoint rounded;
  rounded.p = ToFloat(Placement::Point(placement.to_world, p));
  rounded.p_error = Gamma(1) * Abs(rounded.p) + ToFloat(placement.PointMagnitude(p) * kDoubleError);
  return rounded;
}

/// 1 / pdf of SampleArea(shape, u): the area where the density is even, 0 where there is none.
double InversePdf(const CurvedShape& shape, Vec2d u) {
  return std::visit(
      [&](const auto& s) {
        const LocalPoint local = SampleArea(s, u);
        const double pdf = PdfArea(s, local.p);
        return pdf > 0 ? shape.placement.AreaScale(local.ng) / pdf : 0;
      },
      shape.surface);
}

/// The hit of which PointAt makes `p`, a point of the surface.
template <typename Surface>
SurfaceHit HitAt(const Surface& surface, Vec3d p) {
  if constexpr (std::is_same_v<Surface, BilinearPatchSurface>) {
    const Vec2d uv = ParametersOf(surface, p);
    return {0, p, uv.x, uv.y};
  } else {
    return {0, p};
  }
}

bool HasArea(const BilinearPatchSurface& patch) {
  // Its points are on one line exactly when that is seen from all four corners.
  for (const double u : {0.0, 1.0}) {
    for (const double v : {0.0, 1.0}) {
      if (Length(Cross(patch.DpDu(v), patch.DpDv(u))) > 0) return true;
    }
  }
  return false;
}

Vec3f OuterNormal(const CurvedShape& shape, Vec3d n) {
  const Vec3f normal = ToFloat(Normalize(shape.placement.NormalToWorld(n)));
  return shape.flipped ? -normal : normal;
}

}  // namespace

std::optional<SurfaceHit> Intersect(const CurvedShape& shape, const SurfaceRay& ray) {
  const SurfaceRay local = {Placement::Point(shape.placement.to_object, ray.origin),
                            Placement::Vector(shape.placement.to_object, ray.direction), ray.t_max,
                            ray.t_min};
  return std::visit([&](const auto& s) { return Intersect(s, local); }, shape.surface);
}

SurfacePoint PointOn(const CurvedShape& shape, const SurfaceHit& hit) {
  const LocalPoint local =
      std::visit([&](const auto& s) { return PointAt(s, hit); }, shape.surface);
  const RoundedPoint rounded = ToGroup(shape.placement, local.p);
  SurfacePoint point;
  point.p = rounded.p;
  point.p_error = rounded.p_error;
  point.ng = OuterNormal(shape, local.ng);
  point.ns = OuterNormal(shape, local.ns);
  if (Dot(point.ns, point.ng) < 0) point.ns = -point.ns;
  point.dpdu = ToFloat(Placement::Vector(shape.placement.to_world, local.dpdu));
  point.uv = {static_cast<float>(local.uv.x), static_cast<float>(local.uv.y)};
  point.material = shape.material;
  point.light = shape.light;
  return point;
}

SurfaceDerivatives DerivativesOn(const CurvedShape& shape, const SurfaceHit& hit) {
  const Placement& placement = shape.placement;
  const Vec3d ns = std::visit([&](const auto& s) { return PointAt(s, hit).ns; }, shape.surface);
  const LocalDerivatives local =
      std::visit([&](const auto& s) { return DerivativesAt(s, hit); }, shape.surface);
  // The side that PointOn chooses for the normal.
  const bool flipped = Dot(placement.NormalToWorld(ns), ToDouble(PointOn(shape, hit).ns)) < 0;
  const NormalDerivatives normals(placement, ns, flipped);
  return {ToFloat(Placement::Vector(placement.to_world, local.dpdu)),
          ToFloat(Placement::Vector(placement.to_world, local.dpdv)), normals(local.dndu),
          normals(local.dndv)};
}

EmitterPoint SampleArea(const CurvedShape& shape, Vec2f u) {
  const LocalPoint local = std::visit(
      [&](const auto& s) {
        return SampleArea(s, {u.x, u.y});
      },
      shape.surface);
  const double pdf = std::visit([&](const auto& s) { return PdfArea(s, local.p); }, shape.surface);
  const RoundedPoint rounded = ToGroup(shape.placement, local.p);
  const Vec3f ng = OuterNormal(shape, local.ng);
  return {rounded.p, ng, OffsetDistance(rounded.p, rounded.p_error, ng),
          static_cast<float>(pdf / shape.placement.AreaScale(local.ng))};
}

float PdfArea(const CurvedShape& shape, Vec3f p) {
  const Vec3d local = Placement::Point(shape.placement.to_object, ToDouble(p));
  return std::visit(
      [&](const auto& s) {
        const double scale = shape.placement.AreaScale(NormalAt(s, local));
        return static_cast<float>(PdfArea(s, local) / scale);
      },
      shape.surface);
}

Vec2f UvAt(const CurvedShape& shape, Vec3f p) {
  const Vec3d local = Placement::Point(shape.placement.to_object, ToDouble(p));
  const Vec2d uv =
      std::visit([&](const auto& s) { return PointAt(s, HitAt(s, local)).uv; }, shape.surface);
  return {static_cast<float>(uv.x), static_cast<float>(uv.y)};
}

double AreaOf(const CurvedShape& shape) {
  constexpr int kGrid = 64;
  double sum = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      sum += InversePdf(shape, {(i + 0.5) / kGrid, (j + 0.5) / kGrid});
    }
  }
  return sum / (kGrid * kGrid);
}

bool HasArea(const CurvedShape& shape) {
  if (const auto* patch = std::get_if<BilinearPatchSurface>(&shape.surface)) return HasArea(*patch);
  // The density of the others is even in their own space.
  const double area = InversePdf(shape, {0.5, 0.5});
  return area > 0 && std::isfinite(area);
}

Box BoundsOf(const CurvedShape& shape) {
  const Box local = std::visit([](const auto& s) { return BoundsOf(s); }, shape.surface);
  Box box;
  for (const Vec3d& corner : local.Corners())
    box.Include(Placement::Point(shape.placement.to_world, corner));
  return box;
}

}  // namespace strata
