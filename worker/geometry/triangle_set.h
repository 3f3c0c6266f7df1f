#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "worker/geometry/geometry.h"
#include "worker/geometry/rounding.h"

namespace strata {

/// The triangles of many shapes in one space, as flat arrays that Embree shares: one mesh for all,
/// since a scene of many small meshes traces faster as one.
struct TriangleSet {
  /// All of a vertex within one line of the cache.
  struct alignas(32) Vertex {
    Vec3f p;
    float u = 0;
    Vec3f n;  ///< Unit or zero, on the outer side.
    float v = 0;

    Vec2f Uv() const { return {u, v}; }
  };

  struct Triangle {
    uint32_t vertices[3];
    uint32_t shape : 31;
    uint32_t flipped : 1;  ///< The outer side is opposite to (p1 - p0) x (p2 - p0).
  };
  static_assert(sizeof(Triangle) == 16);

  /// What the triangles of one shape have in common.
  struct Shape {
    /// In parts: what its vertices have.
    static constexpr uint32_t kNormals = 1, kUvs = 2, kSecondUvs = 4;

    MaterialId material = 0;
    int32_t first_light = -1;  ///< Emitter of the first triangle, or -1; the others follow.
    uint32_t first_triangle = 0;
    uint32_t parts = 0;
    uint32_t second_uv_offset = 0;  ///< Added, modulo 2^32, to a vertex index.

    bool Has(uint32_t part) const { return (parts & part) != 0; }
  };

  std::vector<Vertex> vertices;
  std::vector<Vec2f> second_uvs;
  std::vector<Triangle> triangles;
  std::vector<Shape> shapes;
};

struct UnitVector {
  Vec3f direction;
  float inverse_length;  ///< Of what it was made from.
};

/// The unit vector along `v`, whose squared length may lie outside the range of float.
inline UnitVector NormalizeAny(Vec3f v) {
  const float length2 = LengthSquared(v);
  if (length2 > 1e-30f && length2 < 1e30f) {
    const float inverse = 1 / std::sqrt(length2);
    return {v * inverse, inverse};
  }
  const double x = v.x, y = v.y, z = v.z;
  const double length = std::sqrt(x * x + y * y + z * z);
  const double scale = 1 / length;
  return {
      {static_cast<float>(x * scale), static_cast<float>(y * scale), static_cast<float>(z * scale)},
      static_cast<float>(scale)};
}

/// Texture coordinates of a triangle: those of its first corner, and by how much the others differ.
struct TriangleUvs {
  Vec2f uv0, d1 = {1, 0}, d2 = {1, 1};  ///< pbrt's default: (0,0), (1,0), (1,1).

  Vec2f At(float u, float v) const {
    return {uv0.x + Fma(u, d1.x, v * d2.x), uv0.y + Fma(u, d1.y, v * d2.y)};
  }
  float Determinant() const { return d1.x * d2.y - d1.y * d2.x; }
};
inline TriangleUvs UvsBetween(Vec2f uv0, Vec2f uv1, Vec2f uv2) {
  return {uv0, {uv1.x - uv0.x, uv1.y - uv0.y}, {uv2.x - uv0.x, uv2.y - uv0.y}};
}
inline TriangleUvs UvsOf(const TriangleSet& set, const TriangleSet::Triangle& triangle) {
  if (!set.shapes[triangle.shape].Has(TriangleSet::Shape::kUvs)) return {};
  const uint32_t* v = triangle.vertices;
  return UvsBetween(set.vertices[v[0]].Uv(), set.vertices[v[1]].Uv(), set.vertices[v[2]].Uv());
}
inline std::optional<Vec2f> SecondUvAt(const TriangleSet& set,
                                       const TriangleSet::Triangle& triangle, float u, float v) {
  const TriangleSet::Shape& shape = set.shapes[triangle.shape];
  if (!shape.Has(TriangleSet::Shape::kSecondUvs)) return std::nullopt;
  const auto uv = [&](int i) {
    return set.second_uvs[triangle.vertices[i] + shape.second_uv_offset];
  };
  return UvsBetween(uv(0), uv(1), uv(2)).At(u, v);
}

/// The point with barycentric coordinates (1 - u - v, u, v) of a triangle, in the set's space.
///
/// p is p0 + (u e1 + v e2), which lies in the triangle's plane for any u and v, so that only its
/// own roundings count: one of p and at most four of each product. To them p_error adds what the
/// intersector's plane test may err by, seen from a point of this triangle: its distance is
/// ng . (p0 - p) with rounded ng = e1 x e2, so that a ray that leaves p does not meet the triangle
/// again. Each bound is taken per axis; for planes along the axes it is the rounding of p alone.
inline SurfacePoint PointOnTriangle(const TriangleSet& set, uint32_t primitive, float u, float v) {
  const TriangleSet::Triangle& triangle = set.triangles[primitive];
  const TriangleSet::Shape& shape = set.shapes[triangle.shape];
  const TriangleSet::Vertex& v0 = set.vertices[triangle.vertices[0]];
  const TriangleSet::Vertex& v1 = set.vertices[triangle.vertices[1]];
  const TriangleSet::Vertex& v2 = set.vertices[triangle.vertices[2]];
  const Vec3f p0 = v0.p, e1 = v1.p - p0, e2 = v2.p - p0;

  SurfacePoint point;
  point.material = shape.material;
  if (shape.first_light >= 0)
    point.light = shape.first_light + static_cast<int32_t>(primitive - shape.first_triangle);
  point.p = p0 + Fma(e1, u, v * e2);

  const Vec3f cross = Cross(e1, e2);
  const UnitVector normal = NormalizeAny(cross);
  const Vec3f ng = triangle.flipped ? -normal.direction : normal.direction;
  point.ng = point.ns = ng;

  const Vec3f size1 = Abs(e1), size2 = Abs(e2);
  const Vec3f reach = size1 + size2;
  // Rounding of e1 x e2, relative to its length: large for slivers alone.
  const Vec3f cross_terms = {Fma(size1.y, size2.z, size1.z * size2.y),
                             Fma(size1.z, size2.x, size1.x * size2.z),
                             Fma(size1.x, size2.y, size1.y * size2.x)};
  const float tilt = Gamma(3) * Dot(cross_terms, reach) * normal.inverse_length;
  point.p_error = Fma(Abs(point.p), Gamma(1), Fma(reach, Gamma(5), tilt * Abs(ng)));

  const TriangleUvs uvs = UvsOf(set, triangle);
  point.uv = uvs.At(u, v);
  point.second_uv = SecondUvAt(set, triangle, u, v);
  if (const float determinant = uvs.Determinant(); determinant != 0) {
    point.dpdu = (uvs.d2.y * e1 - uvs.d1.y * e2) / determinant;
    if (!IsFinite(point.dpdu)) point.dpdu = {};
  }

  if (shape.Has(TriangleSet::Shape::kNormals)) {
    const Vec3f ns = Fma(v0.n, 1 - u - v, Fma(v1.n, u, v2.n * v));
    const float length2 = LengthSquared(ns);
    // Opposite vertex normals may cancel; what is left of unit vectors then has no direction.
    if (length2 > 1e-8f) {
      const Vec3f unit = ns / std::sqrt(length2);
      point.ns = Dot(unit, ng) < 0 ? -unit : unit;
    }
  }
  return point;
}

/// The derivatives at that point. Zero where the texture coordinates do not vary with the place.
inline SurfaceDerivatives DerivativesOnTriangle(const TriangleSet& set, uint32_t primitive, float u,
                                                float v) {
  const TriangleSet::Triangle& triangle = set.triangles[primitive];
  const TriangleSet::Shape& shape = set.shapes[triangle.shape];
  const TriangleUvs uvs = UvsOf(set, triangle);
  const float determinant = uvs.Determinant();
  SurfaceDerivatives d;
  if (determinant == 0) return d;
  const auto along_u = [&](Vec3f e1, Vec3f e2) {
    return (uvs.d2.y * e1 - uvs.d1.y * e2) / determinant;
  };
  const auto along_v = [&](Vec3f e1, Vec3f e2) {
    return (uvs.d1.x * e2 - uvs.d2.x * e1) / determinant;
  };
  const TriangleSet::Vertex& v0 = set.vertices[triangle.vertices[0]];
  const TriangleSet::Vertex& v1 = set.vertices[triangle.vertices[1]];
  const TriangleSet::Vertex& v2 = set.vertices[triangle.vertices[2]];
  const Vec3f p0 = v0.p, e1 = v1.p - p0, e2 = v2.p - p0;
  d.dpdu = along_u(e1, e2);
  d.dpdv = along_v(e1, e2);
  if (!IsFinite(d.dpdu) || !IsFinite(d.dpdv)) return {};
  if (!shape.Has(TriangleSet::Shape::kNormals)) return d;
  const Vec3f n0 = v0.n, n1 = v1.n - n0, n2 = v2.n - n0;
  const Vec3f ns = n0 + (n1 * u + n2 * v);
  const float length2 = LengthSquared(ns);
  if (!(length2 > 1e-8f)) return d;
  // Of the unit vector along ns, on the side where PointOnTriangle puts it.
  const Vec3f ng = Cross(e1, e2) * (triangle.flipped ? -1.0f : 1.0f);
  const float scale = (Dot(ns, ng) < 0 ? -1 : 1) / std::sqrt(length2);
  const auto turn = [&](Vec3f dn) { return (dn - ns * (Dot(ns, dn) / length2)) * scale; };
  d.dndu = turn(along_u(n1, n2));
  d.dndv = turn(along_v(n1, n2));
  if (!IsFinite(d.dndu) || !IsFinite(d.dndv)) d.dndu = d.dndv = {};
  return d;
}

}  // namespace strata
