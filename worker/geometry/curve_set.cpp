#include "worker/geometry/curve_set.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "worker/geometry/placement.h"
#include "worker/geometry/rounding.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

/// A segment at one parameter.
struct CurvePoint {
  Vec3d p, dpdu;
  double radius = 0, dradius = 0;
};

CurvePoint Evaluate(std::span<const CurveSet::Vertex, 4> v, double u) {
  const double w = 1 - u;
  const double b[4] = {w * w * w, 3 * w * w * u, 3 * w * u * u, u * u * u};
  const double d[3] = {3 * w * w, 6 * w * u, 3 * u * u};
  CurvePoint at;
  for (int i = 0; i < 4; ++i) {
    at.p = at.p + ToDouble(v[i].p) * b[i];
    at.radius += v[i].radius * b[i];
  }
  for (int i = 0; i < 3; ++i) {
    at.dpdu = at.dpdu + (ToDouble(v[i + 1].p) - ToDouble(v[i].p)) * d[i];
    at.dradius += (double{v[i + 1].radius} - v[i].radius) * d[i];
  }
  // Where control points coincide, the curve sets out towards the next one that does not.
  if (Dot(at.dpdu, at.dpdu) == 0) at.dpdu = ToDouble(v[3].p) - ToDouble(v[0].p);
  if (Dot(at.dpdu, at.dpdu) == 0) at.dpdu = {0, 0, 1};
  return at;
}

/// The point at `u` as Embree has it for flat curves: on chords of even steps of u.
CurvePoint EvaluateChord(std::span<const CurveSet::Vertex, 4> v, double u) {
  const double scaled = u * kFlatCurvePieces;
  const double piece = std::clamp(std::floor(scaled), 0.0, kFlatCurvePieces - 1.0);
  const CurvePoint a = Evaluate(v, piece / kFlatCurvePieces);
  const CurvePoint b = Evaluate(v, (piece + 1) / kFlatCurvePieces);
  const double t = scaled - piece;
  return {Lerp(t, a.p, b.p), Lerp(t, a.dpdu, b.dpdu), a.radius + (b.radius - a.radius) * t, 0};
}

Vec3d WithoutPartAlong(Vec3d v, Vec3d unit) { return v - unit * Dot(v, unit); }

/// Unit; any that is orthogonal to unit `axis` where `v` vanishes.
Vec3d NormalizeAcross(Vec3d v, Vec3d axis) {
  if (Dot(v, v) > 0) return Normalize(v);
  return ToDouble(Frame::FromNormal(ToFloat(axis)).x);
}

/// Curves are narrow for their length, and the intersector's error grows with the latter: rays
/// start off the surface by a part of the radius that no picture shows.
Vec3f ErrorAround(Vec3f p, double radius, double extent, Vec3d ng) {
  const double off = radius / 64 + Gamma(16) * extent;
  return Gamma(2) * Abs(p) + ToFloat(Vec3d{std::abs(ng.x), std::abs(ng.y), std::abs(ng.z)} * off);
}

double ExtentOf(std::span<const CurveSet::Vertex, 4> v) {
  double extent = 0;
  for (int i = 1; i < 4; ++i) extent += Length(ToDouble(v[i].p) - ToDouble(v[i - 1].p));
  return extent;
}

}  // namespace

absl::Status AddCurves(const ShapeDescription& shape, const CurveShape& curves,
                       const Transform& placed, bool masked, CurveSets* sets) {
  const auto error = [&](const char* what) {
    return absl::InvalidArgumentError(absl::StrCat(shape.where.ToString(), ": ", what));
  };
  const std::optional<Placement> placement = Placement::From(placed);
  if (!placement) return error("the shape's transform is singular or not affine");
  if (curves.radii.size() != curves.positions.size() ||
      (curves.kind == CurveKind::kRibbon && curves.normals.size() != curves.positions.size()))
    return error("the curve wants a radius for each control point, and a ribbon a normal");
  CurveSet& set = (*sets)[static_cast<size_t>(curves.kind)];
  constexpr size_t kMaxVertices = 0xfffffff0u;
  const size_t base = set.vertices.size();
  if (base + curves.positions.size() > kMaxVertices)
    return error("the scene's curves have more than four thousand million control points");

  const double scale = std::cbrt(std::abs(placement->determinant));
  set.vertices.reserve(base + curves.positions.size());
  for (size_t i = 0; i < curves.positions.size(); ++i) {
    const Vec3d p = Placement::Point(placement->to_world, ToDouble(curves.positions[i]));
    const CurveSet::Vertex vertex = {ToFloat(p), static_cast<float>(curves.radii[i] * scale)};
    if (!IsFinite(vertex.p) || !(vertex.radius >= 0) || !std::isfinite(vertex.radius))
      return error("a control point of the curve lies at no finite place, or its width is none");
    set.vertices.push_back(vertex);
  }
  if (curves.kind == CurveKind::kRibbon) {
    for (const Vec3f& normal : curves.normals)
      set.normals.push_back(ToFloat(Normalize(placement->NormalToWorld(ToDouble(normal)))));
  }
  const int32_t mask = masked ? static_cast<int32_t>(set.masks.size()) : -1;
  if (masked) set.masks.push_back(shape.alpha);
  for (const uint32_t first : curves.segments) {
    if (size_t{first} + 4 > curves.positions.size())
      return error("a segment of the curve has no four control points");
    const auto at = set.vertices.begin() + static_cast<ptrdiff_t>(base + first);
    const bool is_wide = std::any_of(at, at + 4, [](const auto& v) { return v.radius > 0; });
    if (!is_wide) continue;
    set.segments.push_back({static_cast<uint32_t>(base + first), shape.material,
                            shape.reverse_orientation ? 1u : 0u, mask});
  }
  return absl::OkStatus();
}

SurfacePoint PointOnCurve(const CurveSets& sets, CurveKind kind, const Hit& hit,
                          const SurfaceRay& ray) {
  const CurveSet& set = sets[static_cast<size_t>(kind)];
  const CurveSet::Segment& segment = set.segments[hit.primitive];
  const std::span<const CurveSet::Vertex, 4> vertices(&set.vertices[segment.first_vertex], 4);
  const CurvePoint at =
      kind == CurveKind::kFlat ? EvaluateChord(vertices, hit.u) : Evaluate(vertices, hit.u);
  const Vec3d tangent = Normalize(at.dpdu), view = Normalize(ray.direction);
  const Vec3d side = NormalizeAcross(Cross(view, tangent), tangent);
  const Vec3d on_ray = ray.origin + ray.direction * hit.t;

  Vec3d p, ng, dpdu = at.dpdu;
  double v = hit.v;
  if (kind == CurveKind::kFlat) {
    // Its plane holds the curve and stands across the ray as far as it can.
    p = on_ray + view * Dot(at.p - on_ray, view);
    ng = NormalizeAcross(WithoutPartAlong(-view, tangent), tangent);
    v = 0.5 + 0.5 * std::clamp(Dot(p - at.p, side) / std::max(at.radius, 1e-300), -1.0, 1.0);
  } else if (kind == CurveKind::kCylinder) {
    const Vec3d outwards = NormalizeAcross(WithoutPartAlong(on_ray - at.p, tangent), tangent);
    p = at.p + outwards * at.radius;
    dpdu = at.dpdu + outwards * at.dradius;
    ng = Normalize(outwards * Dot(at.dpdu, at.dpdu) - at.dpdu * at.dradius);
    v = 0.5 + 0.5 * Dot(outwards, side);
  } else {
    p = on_ray;
    ng = NormalizeAcross(ToDouble(hit.local), tangent);
  }
  if (kind != CurveKind::kFlat && segment.flipped) ng = -ng;

  SurfacePoint point;
  point.p = ToFloat(p);
  point.p_error = ErrorAround(point.p, at.radius, ExtentOf(vertices), ng);
  if (kind != CurveKind::kCylinder) {
    const Vec3d way = ray.direction * hit.t;
    point.p_error += Gamma(4) * (Abs(ToFloat(ray.origin)) + Abs(ToFloat(way)));
  }
  point.ng = point.ns = ToFloat(ng);
  point.dpdu = ToFloat(dpdu);
  point.uv = {hit.u, static_cast<float>(v)};
  point.material = segment.material;
  return point;
}

Box BoundsOf(const CurveSets& sets) {
  Box box;
  for (const CurveSet& set : sets) {
    for (const CurveSet::Vertex& vertex : set.vertices) {
      const double r = vertex.radius;
      const Vec3d p = ToDouble(vertex.p);
      box.Include(p - Vec3d{r, r, r});
      box.Include(p + Vec3d{r, r, r});
    }
  }
  return box;
}

}  // namespace strata
