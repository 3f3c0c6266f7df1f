#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"

namespace strata {

/// A rectangle as it is seen from a point, which is the origin of its coordinates here: x and y
/// along the edges, z towards the point. Sampled uniformly by solid angle (Urena, Fajardo and King
/// 2013, "An Area-Preserving Parametrization for Spherical Rectangles"). The density by solid angle
/// is 1 / solid_angle.
struct SphericalRectangle {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0, z0 = 0;  ///< Of the corners; z0 is negative.
  float b0 = 0, b1 = 0, k = 0;
  float solid_angle = 0;  ///< Within 1e-6; 0 or less: the point lies in the rectangle's plane.

  /// The rectangle at `corner` with edges along the unit vectors, which are orthogonal to each
  /// other and to `normal`.
  SphericalRectangle(Vec3f corner, Vec3f unit1, float length1, Vec3f unit2, float length2,
                     Vec3f normal, Vec3f from) {
    const Vec3f d = corner - from;
    z0 = -AbsDot(d, normal);
    x0 = Dot(d, unit1);
    y0 = Dot(d, unit2);
    x1 = x0 + length1;
    y1 = y0 + length2;
    FindSolidAngle();
  }

  /// A point of the rectangle, in parts of its edges.
  Vec2f Sample(Vec2f u) const {
    constexpr float kTiny = 1e-12f;
    const SinCosResult<float> angle = SinCos(u.x * solid_angle + k);
    const float f = (angle.cos * b0 - b1) / angle.sin;
    const float c = std::copysign(1 / std::sqrt(f * f + b0 * b0), f);
    const float x = std::clamp(-(c * z0) / std::sqrt(std::max(1 - c * c, kTiny)), x0, x1);
    const float d2 = x * x + z0 * z0;
    const float h0 = y0 / std::sqrt(d2 + y0 * y0), h1 = y1 / std::sqrt(d2 + y1 * y1);
    const float h = h0 + u.y * (h1 - h0);
    const float y = std::clamp(h * std::sqrt(d2 / std::max(1 - h * h, kTiny)), y0, y1);
    return {(x - x0) / (x1 - x0), (y - y0) / (y1 - y0)};
  }

  /// The u that Sample takes to the point at these parts of the edges: how much of the solid angle
  /// lies before x, and of the arc at x before y. Within 1e-6 over the solid angle.
  Vec2f Invert(Vec2f parts) const {
    SphericalRectangle before = *this;
    before.x1 = x0 + parts.x * (x1 - x0);
    before.FindSolidAngle();
    const float y = y0 + parts.y * (y1 - y0);
    const float d2 = before.x1 * before.x1 + z0 * z0;
    const auto height = [d2](float c) { return c / std::sqrt(d2 + c * c); };
    return {before.solid_angle / solid_angle, (height(y) - height(y0)) / (height(y1) - height(y0))};
  }

 private:
  /// The angles between the planes through the point and the edges add up to 2 pi and the solid
  /// angle.
  void FindSolidAngle() {
    const float zz = z0 * z0;
    if (!(zz > 0)) return;
    const auto slope = [zz](float c) { return c / std::sqrt(zz + c * c); };
    const float n0 = -slope(y0), n1 = slope(x1), n2 = slope(y1), n3 = -slope(x0);
    k = 2 * kPi - Acos(-n2 * n3) - Acos(-n3 * n0);
    b0 = n0;
    b1 = n2;
    solid_angle = Acos(-n0 * n1) + Acos(-n1 * n2) - k;
  }
};

}  // namespace strata
