#pragma once

#include "worker/math/elementary_lanes.h"

namespace strata {

/// By which lengths at a rectangle become parts of the root of its area; and scalar products with
/// its edges, coordinates along them in that unit.
struct RectangleScales {
  float length = 0, edge1 = 0, edge2 = 0;
};
inline RectangleScales ScalesOf(Vec3f edge1, Vec3f edge2) {
  const float length1 = Length(edge1), length2 = Length(edge2);
  const float scale = 1 / (std::sqrt(length1) * std::sqrt(length2));
  return {scale, scale / length1, scale / length2};
}

/// A rectangle, or eight side by side, as it is seen from a point, which is the origin of its
/// coordinates here: x and y along the edges, z towards the point. Sampled uniformly by solid angle
/// (Urena, Fajardo and King 2013, "An Area-Preserving Parametrization for Spherical Rectangles";
/// PBRT 6.6.2). The density by solid angle is 1 / solid_angle.
///
/// Lengths are in roots of the rectangle's area, so that no product of some of them leaves the
/// range of float.
template <typename Float>
struct SphericalRectangleOf {
  using Vec2 = typename VectorsOf<Float>::Vec2;
  using Vec3 = typename VectorsOf<Float>::Vec3;

  Float length1 = {}, length2 = {};                   ///< Of the edges; their product is 1.
  Float x0 = {}, y0 = {}, x1 = {}, y1 = {}, z0 = {};  ///< Of the corners; z0 is negative.
  /// Within 1e-6 of what belongs to these coordinates. 0: the point lies in the rectangle's plane.
  Float solid_angle = {};

  /// The rectangle at `corner` with these edges, which are orthogonal to each other and to the unit
  /// vector `normal`; `scale` and the edges' are its RectangleScales.
  SphericalRectangleOf(Vec3 corner, Vec3 edge1, Float scale1, Vec3 edge2, Float scale2, Vec3 normal,
                       Float scale, Vec3 from) {
    const Vec3 d = corner - from;
    length1 = LengthSquared(edge1) * scale1;
    length2 = LengthSquared(edge2) * scale2;
    z0 = -AbsDot(d, normal) * scale;
    x0 = Dot(d, edge1) * scale1;
    y0 = Dot(d, edge2) * scale2;
    x1 = x0 + length1;
    y1 = y0 + length2;
    at_x0_ = AnglesAt(x0);
    solid_angle = SolidAngleUpTo(x1);
  }

  /// A point of the rectangle, in parts of its edges.
  Vec2 Sample(Vec2 u) const {
    const Float tiny = Float{} + 1e-12f;
    const Float zz = z0 * z0;
    const Float inverse0 = 1 / Sqrt(Fma(y0, y0, zz)), inverse1 = 1 / Sqrt(Fma(y1, y1, zz));
    const Float b0 = -y0 * inverse0, b1 = y1 * inverse1;
    // The paper's angle k is that of at_x0_ the other way round; u.x of the solid angle is added.
    const Float unit = inverse0 * inverse1 / Fma(x0, x0, zz);
    const Float cos_k = at_x0_.cos * unit, sin_k = -at_x0_.sin * unit;
    const SinCosResult<Float> part = SinCos2Pi(u.x * solid_angle * (kInvPi / 2));
    const Float cos = Fma(part.cos, cos_k, -part.sin * sin_k),
                sin = Fma(part.sin, cos_k, part.cos * sin_k);
    // With f = (cos b0 - b1) / sin, the cosine c = 1 / sqrt(f^2 + b0^2) with the sign of f makes
    // x = -c z0 / sqrt(1 - c^2), from which c goes out.
    const Float f_sin = Fma(cos, b0, -b1);
    const Float sin_z = sin * inverse0 * z0;
    const Float root = Sqrt(Max(Fma(f_sin, f_sin, -sin_z * sin_z), tiny));
    const Float x = Min(Max(CopySign(sin * z0 / root, sin * f_sin), x0), x1);
    const Float d2 = Fma(x, x, zz);
    const Float h0 = y0 / Sqrt(Fma(y0, y0, d2)), h1 = y1 / Sqrt(Fma(y1, y1, d2));
    const Float h = Fma(u.y, h1 - h0, h0);
    const Float y = Min(Max(h * Sqrt(d2 / Max(Fma(-h, h, Float{} + 1), tiny)), y0), y1);
    // Each length is the inverse of the other.
    const Float all = Float{} + 1;
    return {Min((x - x0) * length2, all), Min((y - y0) * length1, all)};
  }

  /// The u that Sample takes to the point at these parts of the edges: how much of the solid angle
  /// lies before x, and of the arc at x before y. Within 1e-6 over the solid angle.
  Vec2 Invert(Vec2 parts) const {
    const Float x = x0 + parts.x * length1, y = y0 + parts.y * length2;
    const Float d2 = x * x + z0 * z0;
    const auto height = [d2](Float c) { return c / Sqrt(d2 + c * c); };
    return {SolidAngleUpTo(x) / solid_angle, (height(y) - height(y0)) / (height(y1) - height(y0))};
  }

 private:
  /// The planes through the point and two edges that meet at (x, y) make an angle whose tangent is
  /// that of (x y, -z0 distance): for the edge at x and those at y0 and y1 the sum of both, as
  /// sine and cosine times the same factor.
  SinCosResult<Float> AnglesAt(Float x) const {
    const Float zz = z0 * z0, xx_zz = Fma(x, x, zz);
    const Float distance0 = Sqrt(Fma(y0, y0, xx_zz)), distance1 = Sqrt(Fma(y1, y1, xx_zz));
    return {-x * z0 * Fma(y1, distance0, -y0 * distance1),
            -Fma(x * x, y0 * y1, zz * distance0 * distance1)};
  }

  /// That of the part from x0 to x: by so much the angles at both ends differ.
  Float SolidAngleUpTo(Float x) const {
    const SinCosResult<Float> at_x = AnglesAt(x);
    const Float angle = Atan2(Fma(at_x0_.sin, at_x.cos, -at_x0_.cos * at_x.sin),
                              Fma(at_x0_.cos, at_x.cos, at_x0_.sin * at_x.sin));
    // More than half a turn is seen before the rectangle alone.
    const auto before = (x0 * x < 0) & (y0 * y1 < 0);
    const Float whole = angle < 0 ? (before ? angle + 2 * kPi : Float{}) : angle;
    return z0 < 0 ? whole : Float{};
  }

  SinCosResult<Float> at_x0_ = {};
};
using SphericalRectangle = SphericalRectangleOf<float>;

}  // namespace strata
