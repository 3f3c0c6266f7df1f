#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"
#include "worker/pbrt/entities.h"

// Shape "curve" (PBRT 6.7): whatever basis and degree its file has, cubic Bezier segments come out.

namespace strata {
namespace {

/// The Bezier control points of one segment, from `degree` + 1 points of its basis.
std::array<Vec3d, 4> BezierOf(const Vec3f* points, int degree, bool is_spline) {
  const auto p = [&](int i) { return ToDouble(points[i]); };
  if (degree == 3) {
    if (!is_spline) return {p(0), p(1), p(2), p(3)};
    // By blossoming the knots -2 .. 3 of the uniform spline.
    return {(p(0) + p(1) * 4 + p(2)) * (1.0 / 6), Lerp(1.0 / 3, p(1), p(2)),
            Lerp(2.0 / 3, p(1), p(2)), (p(1) + p(2) * 4 + p(3)) * (1.0 / 6)};
  }
  const Vec3d a = is_spline ? Lerp(0.5, p(0), p(1)) : p(0), b = p(1),
              c = is_spline ? Lerp(0.5, p(1), p(2)) : p(2);
  // The cubic that is this quadratic.
  return {a, Lerp(2.0 / 3, a, b), Lerp(1.0 / 3, b, c), c};
}

/// Between unit vectors along the great arc.
Vec3f SlerpNormals(Vec3f a, Vec3f b, double t) {
  const Vec3d from = Normalize(ToDouble(a)), to = Normalize(ToDouble(b));
  const double angle = Acos(std::clamp(Dot(from, to), -1.0, 1.0)), sine = Sin(angle);
  if (!(sine > 1e-6)) return ToFloat(Lerp(t, from, to));
  return ToFloat(from * (Sin((1 - t) * angle) / sine) + to * (Sin(t * angle) / sine));
}

CurveKind ReadKind(ParameterReader& parameters) {
  const std::string type = parameters.String("type", "flat");
  if (type == "cylinder") return CurveKind::kCylinder;
  if (type == "ribbon") return CurveKind::kRibbon;
  if (type != "flat") {
    parameters.Fail(parameters.where(),
                    StrCat("unknown type \"", type, "\" of a curve; use flat, cylinder or ribbon"));
  }
  return CurveKind::kFlat;
}

/// The normals of a ribbon's control points, from those of its segments' ends.
std::vector<Vec3f> ControlNormals(const std::vector<Vec3f>& ends) {
  std::vector<Vec3f> normals;
  for (size_t i = 0; i + 1 < ends.size(); ++i) {
    for (int k = 0; k < 3; ++k) normals.push_back(SlerpNormals(ends[i], ends[i + 1], k / 3.0));
  }
  normals.push_back(SlerpNormals(ends.back(), ends.back(), 0));
  return normals;
}

}  // namespace

CurveShape ReadCurve(ParameterReader& parameters) {
  const SourceLocation& where = parameters.where();
  CurveShape curve;
  curve.kind = ReadKind(parameters);
  const int degree = parameters.Integer("degree", 3);
  if (degree != 2 && degree != 3) parameters.Fail(where, "a curve's \"degree\" must be 2 or 3");
  const std::string basis = parameters.String("basis", "bezier");
  const bool is_spline = basis == "bspline";
  if (!is_spline && basis != "bezier") {
    parameters.Fail(where,
                    StrCat("unknown basis \"", basis, "\" of a curve; use bezier or bspline"));
  }
  const double width = parameters.Float("width", 1);
  const double width0 = parameters.Float("width0", width);
  const double width1 = parameters.Float("width1", width);
  if (!(width0 >= 0 && width1 >= 0)) parameters.Fail(where, "a curve's width is negative");
  parameters.Integer("splitdepth", 3);  // how pbrt searches for hits
  const std::vector<Vec3f> points = parameters.Point3s("P");
  const std::vector<Vec3f> ends = parameters.Normals("N");
  if (!parameters.ok()) return curve;

  const int count = static_cast<int>(points.size());
  const bool fits = count > degree && (is_spline || (count - 1) % degree == 0);
  if (!fits) {
    parameters.Fail(where, StrCat("a ", basis, " curve of degree ", degree, " has ",
                                  is_spline ? StrCat(degree + 1, " or more")
                                            : StrCat("a multiple of ", degree, " and one"),
                                  " control points \"point3 P\", not ", count));
    return curve;
  }
  const int segments = is_spline ? count - degree : (count - 1) / degree;
  if (curve.kind == CurveKind::kRibbon && static_cast<int>(ends.size()) != segments + 1) {
    parameters.Fail(where, StrCat("a ribbon of ", segments, " segments wants ", segments + 1,
                                  " normals \"normal N\", not ", ends.size()));
    return curve;
  }
  if (curve.kind == CurveKind::kRibbon) curve.normals = ControlNormals(ends);
  for (int i = 0; i < segments; ++i) {
    const auto controls = BezierOf(&points[i * (is_spline ? 1 : degree)], degree, is_spline);
    curve.segments.push_back(static_cast<uint32_t>(3 * i));
    // Segments share their ends.
    for (int k = i == 0 ? 0 : 1; k < 4; ++k) curve.positions.push_back(ToFloat(controls[k]));
  }
  for (int i = 0; i <= 3 * segments; ++i) {
    const double t = i / (3.0 * segments);
    curve.radii.push_back(static_cast<float>(0.5 * (width0 + (width1 - width0) * t)));
  }
  return curve;
}

bool JoinCurves(ShapeDescription& shape, const ShapeDescription& next) {
  auto* curves = std::get_if<CurveShape>(&shape.geometry);
  const auto* more = std::get_if<CurveShape>(&next.geometry);
  if (!curves || !more || curves->kind != more->kind || shape.material != next.material ||
      shape.reverse_orientation != next.reverse_orientation || shape.alpha != next.alpha ||
      shape.to_world != next.to_world || shape.border != next.border)
    return false;
  constexpr size_t kMaxVertices = 0x7fffffff;
  if (curves->positions.size() + more->positions.size() > kMaxVertices) return false;
  const uint32_t base = static_cast<uint32_t>(curves->positions.size());
  for (const uint32_t first : more->segments) curves->segments.push_back(base + first);
  const auto append = [](auto& to, const auto& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(curves->positions, more->positions);
  append(curves->radii, more->radii);
  append(curves->normals, more->normals);
  return true;
}

}  // namespace strata
