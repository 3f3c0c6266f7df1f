#include "worker/geometry/geometry_lanes.h"

#include "worker/geometry/state.h"
#include "worker/math/cpu_clones.h"

namespace strata {
namespace {

void Store(float* to, FloatLanes v) { _mm256_store_ps(to, v); }
FloatLanes Load(const float* from) { return _mm256_load_ps(from); }
IntLanes Load(const unsigned* from) {
  return reinterpret_cast<IntLanes>(_mm256_load_si256(reinterpret_cast<const __m256i*>(from)));
}
void Store(unsigned* to, IntLanes v) {
  _mm256_store_si256(reinterpret_cast<__m256i*>(to), reinterpret_cast<__m256i>(v));
}

void SetRays(const RayLanes& from, RTCRay8* to) {
  Store(to->org_x, from.origin.x);
  Store(to->org_y, from.origin.y);
  Store(to->org_z, from.origin.z);
  Store(to->tnear, SameFloat(std::numeric_limits<float>::min()));
  Store(to->dir_x, from.direction.x);
  Store(to->dir_y, from.direction.y);
  Store(to->dir_z, from.direction.z);
  Store(to->time, from.time);
  Store(to->tfar, from.t_max);
  Store(to->mask, SameInt(-1));
  Store(to->id, from.id);
  Store(to->flags, IntLanes{});
}

/// PointOnTriangle, but for what only some materials ask for.
STRATA_CPU_CLONES void PointsOnTriangles(const TriangleSet& set, const HitLanes& hits,
                                         MaskLanes mask, bool with_uv, SurfaceLanes* surface) {
  const auto bits = [](FloatLanes v) { return reinterpret_cast<IntLanes>(v); };
  const RowLanes triangle =
      GatherRows(reinterpret_cast<const float*>(set.triangles.data()), hits.primitive * 4, mask);
  const IntLanes v0 = bits(triangle.v[0]), v1 = bits(triangle.v[1]), v2 = bits(triangle.v[2]),
                 last = bits(triangle.v[3]);
  const MaskLanes flipped = last < 0;
  using Shape = TriangleSet::Shape;
  static_assert(sizeof(Shape) == 20);
  const RowLanes shape =
      GatherRows(reinterpret_cast<const float*>(set.shapes.data()), (last & 0x7fffffff) * 5, mask);
  surface->material = bits(shape.v[0]);
  const IntLanes first_light = bits(shape.v[1]), first_triangle = bits(shape.v[2]),
                 parts = bits(shape.v[3]);
  surface->light = first_light >= 0 ? first_light + (hits.primitive - first_triangle) : SameInt(-1);

  static_assert(sizeof(TriangleSet::Vertex) == 8 * sizeof(float));
  const float* vertices = &set.vertices.front().p.x;
  const LanePlaces at0 = PlacesOf(v0 * 8 & mask), at1 = PlacesOf(v1 * 8 & mask),
                   at2 = PlacesOf(v2 * 8 & mask);
  const auto vector = [](const RowLanes& row) { return Vec3Lanes{row.v[0], row.v[1], row.v[2]}; };
  const RowLanes p0_u0 = LoadRows(vertices, at0), p1_u1 = LoadRows(vertices, at1),
                 p2_u2 = LoadRows(vertices, at2);
  const Vec3Lanes p0 = vector(p0_u0), e1 = vector(p1_u1) - p0, e2 = vector(p2_u2) - p0;
  const Vec3Lanes p = p0 + Fma(e1, hits.u, hits.v * e2);

  const Vec3Lanes cross = Cross(e1, e2);
  const FloatLanes length2 = LengthSquared(cross);
  FloatLanes inverse = 1 / Sqrt(length2);
  Vec3Lanes normal = cross * inverse;
  const MaskLanes extreme = mask & ~((length2 > 1e-30f) & (length2 < 1e30f));
  ForEachLane(extreme, [&](int lane) {
    const UnitVector unit = NormalizeAny(cross.Get(lane));
    normal.Set(lane, unit.direction);
    inverse[lane] = unit.inverse_length;
  });
  const Vec3Lanes ng = Select(flipped, -normal, normal);

  const Vec3Lanes size1 = Abs(e1), size2 = Abs(e2), reach = size1 + size2;
  const Vec3Lanes cross_terms = {Fma(size1.y, size2.z, size1.z * size2.y),
                                 Fma(size1.z, size2.x, size1.x * size2.z),
                                 Fma(size1.x, size2.y, size1.y * size2.x)};
  const FloatLanes tilt = Gamma(3) * Dot(cross_terms, reach) * inverse;
  const Vec3Lanes size = Abs(ng);
  const Vec3Lanes p_error =
      Fma(Abs(p), SameFloat(Gamma(1)), Fma(reach, SameFloat(Gamma(5)), size * tilt));
  surface->p = p;
  surface->ng = ng;
  surface->offset = Dot(size, Fma(Abs(p), SameFloat(Gamma(3)), p_error)) * (1 + Gamma(16));

  const MaskLanes smooth = mask & ((parts & Shape::kNormals) != 0),
                  mapped = with_uv ? mask & ((parts & Shape::kUvs) != 0) : MaskLanes{};
  surface->ns = ng;
  surface->uv = {hits.u + hits.v, hits.v};  // See TriangleUvs.
  if (!Any(smooth | mapped)) return;
  const RowLanes n0_v0 = LoadRows(vertices + 4, at0), n1_v1 = LoadRows(vertices + 4, at1),
                 n2_v2 = LoadRows(vertices + 4, at2);
  if (Any(smooth)) {
    const Vec3Lanes ns =
        Fma(vector(n0_v0), 1 - hits.u - hits.v, Fma(vector(n1_v1), hits.u, vector(n2_v2) * hits.v));
    const FloatLanes ns2 = LengthSquared(ns);
    const Vec3Lanes unit = ns * (1 / Sqrt(ns2));
    const MaskLanes usable = smooth & (ns2 > 1e-8f);
    surface->ns = Select(usable, Select(Dot(unit, ng) < 0, -unit, unit), ng);
  }
  const auto at = [&](FloatLanes c0, FloatLanes c1, FloatLanes c2) {
    return c0 + Fma(hits.u, c1 - c0, hits.v * (c2 - c0));
  };
  surface->uv.x = mapped ? at(p0_u0.v[3], p1_u1.v[3], p2_u2.v[3]) : surface->uv.x;
  surface->uv.y = mapped ? at(n0_v0.v[3], n1_v1.v[3], n2_v2.v[3]) : surface->uv.y;
}

}  // namespace

MaskLanes Intersect(const Geometry& geometry, const RayLanes& rays, MaskLanes active,
                    HitLanes* hits) {
  const FewTriangles& few = geometry.state().few;
  if (!few.empty()) return few.Intersect(rays, active, hits);
  RTCRayHit8 packet;
  SetRays(rays, &packet.ray);
  Store(packet.hit.geomID, SameInt(-1));
  Store(packet.hit.instID[0], SameInt(-1));
  alignas(32) IntLanes valid = active;
  embree::Intersect8(reinterpret_cast<const int*>(&valid), geometry.state().world.scene, &packet);
  hits->t = Load(packet.ray.tfar);
  hits->u = Load(packet.hit.u);
  hits->v = Load(packet.hit.v);
  hits->local = {Load(packet.hit.Ng_x), Load(packet.hit.Ng_y), Load(packet.hit.Ng_z)};
  hits->geometry = Load(packet.hit.geomID);
  hits->primitive = Load(packet.hit.primID);
  hits->instance = Load(packet.hit.instID[0]);
  return active & (hits->geometry != -1);
}

MaskLanes Occluded(const Geometry& geometry, const RayLanes& rays, MaskLanes active) {
  const FewTriangles& few = geometry.state().few;
  if (!few.empty()) return few.Occluded(rays, active);
  RTCRay8 packet;
  SetRays(rays, &packet);
  alignas(32) IntLanes valid = active;
  embree::Occluded8(reinterpret_cast<const int*>(&valid), geometry.state().world.scene, &packet);
  return active & (Load(packet.tfar) < 0);
}

void FindSurfaces(const Geometry& geometry, const RayLanes& rays, const HitLanes& hits,
                  MaskLanes hit, bool with_uv, SurfaceLanes* surfaces) {
  const MaskLanes triangles =
      hit & (hits.geometry == static_cast<int32_t>(kTriangleGeometry)) & (hits.instance == -1);
  if (Any(triangles))
    PointsOnTriangles(geometry.state().world.triangles, hits, triangles, with_uv, surfaces);
  ForEachLane(hit & ~triangles, [&](int lane) {
    surfaces->Set(lane, geometry.Surface(rays.Get(lane), hits.Get(lane)));
  });
}

}  // namespace strata
