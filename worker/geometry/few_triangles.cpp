#include "worker/geometry/few_triangles.h"

#include <cmath>

#include "worker/geometry/state.h"
#include "worker/math/cpu_clones.h"

namespace strata {
namespace {

/// a * b - c
FloatLanes Fms(FloatLanes a, FloatLanes b, FloatLanes c) { return _mm256_fmsub_ps(a, b, c); }

Vec3Lanes FmaCross(Vec3Lanes a, Vec3Lanes b) {
  return {Fms(a.y, b.z, a.z * b.y), Fms(a.z, b.x, a.x * b.z), Fms(a.x, b.y, a.y * b.x)};
}

FloatLanes FlipSign(FloatLanes v, IntLanes sign) {
  return reinterpret_cast<FloatLanes>(reinterpret_cast<IntLanes>(v) ^ sign);
}

}  // namespace

/// The plane and the barycentric coordinates of hits as quotients: over `denominator`, which is not
/// negative.
struct FewTriangles::Test {
  FloatLanes t, u, v, denominator;
  MaskLanes inside;

  Test(const Triangle& triangle, const RayLanes& rays) {
    const Vec3Lanes to_corner = SameVector(triangle.p0) - rays.origin;
    const Vec3Lanes moment = FmaCross(to_corner, rays.direction);
    const FloatLanes facing = Dot(rays.direction, SameVector(triangle.normal));
    const IntLanes sign = reinterpret_cast<IntLanes>(facing) & static_cast<int32_t>(0x80000000);
    denominator = Abs(facing);
    t = FlipSign(Dot(to_corner, SameVector(triangle.normal)), sign);
    u = FlipSign(Dot(moment, SameVector(triangle.e2)), sign);
    v = FlipSign(Dot(moment, SameVector(triangle.minus_e1)), sign);
    inside = (u >= 0) & (v >= 0) & (u + v <= denominator) & (t > 0);
  }
};

FewTriangles::FewTriangles(const TriangleSet& set) {
  if (set.triangles.size() > kMost) return;
  triangles_.reserve(set.triangles.size());
  for (size_t i = 0; i < set.triangles.size(); ++i) {
    const auto& corners = set.triangles[i].vertices;
    const Vec3f p0 = set.vertices[corners[0]].p;
    const Vec3d e1 = ToDouble(set.vertices[corners[1]].p - p0),
                e2 = ToDouble(set.vertices[corners[2]].p - p0);
    const Vec3d normal = Cross(e1, e2);
    const double length = Length(normal);
    // No ray meets what has no area.
    if (!(length > 0 && std::isfinite(length))) continue;
    const double scale = std::ldexp(1.0, -std::ilogb(length));
    triangles_.push_back({p0, ToFloat(e2 * scale), ToFloat(e1 * -scale), ToFloat(normal * scale),
                          static_cast<int32_t>(i)});
  }
}

STRATA_CPU_CLONES MaskLanes FewTriangles::Intersect(const RayLanes& rays, MaskLanes active,
                                                    HitLanes* hits) const {
  // The nearest yet, as quotients over `denominator`.
  FloatLanes t = rays.t_max, u = {}, v = {}, denominator = SameFloat(1);
  IntLanes primitive = SameInt(-1);
  for (const Triangle& triangle : triangles_) {
    const Test test(triangle, rays);
    const MaskLanes nearer = test.inside & (test.t * denominator < t * test.denominator);
    t = nearer ? test.t : t;
    u = nearer ? test.u : u;
    v = nearer ? test.v : v;
    denominator = nearer ? test.denominator : denominator;
    primitive = nearer ? SameInt(triangle.primitive) : primitive;
  }
  const FloatLanes inverse = 1 / denominator;
  hits->t = t * inverse;
  hits->u = u * inverse;
  hits->v = v * inverse;
  hits->geometry = SameInt(kTriangleGeometry);
  hits->primitive = primitive;
  hits->instance = SameInt(-1);
  return active & (primitive >= 0);
}

STRATA_CPU_CLONES MaskLanes FewTriangles::Occluded(const RayLanes& rays, MaskLanes active) const {
  MaskLanes open = active;
  for (const Triangle& triangle : triangles_) {
    const Test test(triangle, rays);
    open &= ~(test.inside & (test.t < rays.t_max * test.denominator));
    if (!Any(open)) break;
  }
  return active & ~open;
}

}  // namespace strata
