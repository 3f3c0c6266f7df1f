#pragma once

#include "worker/math/elementary_lanes.h"

namespace strata {

/// A rectangle, or eight side by side, as it is seen from a point, which is the origin of its
/// coordinates here: x and y along the edges, z towards the point. Sampled uniformly by solid angle
/// (Urena, Fajardo and King 2013, "An Area-Preserving Parametrization for Spherical Rectangles";
/// PBRT 6.6.2). The density by solid angle is 1 / solid_angle.
template <typename Float>
struct SphericalRectangleOf {
  using Vec2 = typename VectorsOf<Float>::Vec2;
  using Vec3 = typename VectorsOf<Float>::Vec3;

  Float x0 = {}, y0 = {}, x1 = {}, y1 = {}, z0 = {};  ///< Of the corners; z0 is negative.
  Float b0 = {}, b1 = {}, k = {};
  /// Within 1e-6; some 1e-5 where it is seen edge-on, since angles are then told by cosines near 1.
  /// 0 or less: the point lies in the rectangle's plane.
  Float solid_angle = {};

  /// The rectangle at `corner` with edges along the unit vectors, which are orthogonal to each
  /// other and to `normal`.
  SphericalRectangleOf(Vec3 corner, Vec3 unit1, Float length1, Vec3 unit2, Float length2,
                       Vec3 normal, Vec3 from) {
    const Vec3 d = corner - from;
    z0 = -AbsDot(d, normal);
    x0 = Dot(d, unit1);
    y0 = Dot(d, unit2);
    x1 = x0 + length1;
    y1 = y0 + length2;
    FindSolidAngle();
  }

  /// A point of the rectangle, in parts of its edges.
  Vec2 Sample(Vec2 u) const {
    const Float tiny = Float{} + 1e-12f;
    const SinCosResult<Float> angle = SinCos2Pi((u.x * solid_angle + k) * (kInvPi / 2));
    // With f = (cos b0 - b1) / sin, the cosine c = 1 / sqrt(f^2 + b0^2) with the sign of f makes
    // x = -c z0 / sqrt(1 - c^2), from which c goes out.
    const Float f_sin = angle.cos * b0 - b1;
    const Float root = Sqrt(Max(f_sin * f_sin - angle.sin * angle.sin * (1 - b0 * b0), tiny));
    const Float x = Min(Max(CopySign(angle.sin * z0 / root, angle.sin * f_sin), x0), x1);
    const Float d2 = x * x + z0 * z0;
    const Float h0 = y0 / Sqrt(d2 + y0 * y0), h1 = y1 / Sqrt(d2 + y1 * y1);
    const Float h = h0 + u.y * (h1 - h0);
    const Float y = Min(Max(h * Sqrt(d2 / Max(1 - h * h, tiny)), y0), y1);
    return {(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)};
  }

  /// The u that Sample takes to the point at these parts of the edges: how much of the solid angle
  /// lies before x, and of the arc at x before y. Within 1e-6 over the solid angle.
  Vec2 Invert(Vec2 parts) const {
    SphericalRectangleOf before = *this;
    before.x1 = x0 + parts.x * (x1 - x0);
    before.FindSolidAngle();
    const Float y = y0 + parts.y * (y1 - y0);
    const Float d2 = before.x1 * before.x1 + z0 * z0;
    const auto height = [d2](Float c) { return c / Sqrt(d2 + c * c); };
    return {before.solid_angle / solid_angle, (height(y) - height(y0)) / (height(y1) - height(y0))};
  }

 private:
  /// The angles between the planes through the point and the edges add up to 2 pi and the solid
  /// angle.
  void FindSolidAngle() {
    const Float zz = z0 * z0;
    const auto slope = [zz](Float c) { return c / Sqrt(zz + c * c); };
    const Float n0 = -slope(y0), n1 = slope(x1), n2 = slope(y1), n3 = -slope(x0);
    k = 2 * kPi - Acos(-n2 * n3) - Acos(-n3 * n0);
    b0 = n0;
    b1 = n2;
    const Float angle = Acos(-n0 * n1) + Acos(-n1 * n2) - k;
    solid_angle = zz > 0 ? angle : Float{};
  }
};
using SphericalRectangle = SphericalRectangleOf<float>;

}  // namespace strata
