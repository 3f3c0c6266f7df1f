#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"
#include "worker/math/vec3d.h"

namespace strata {

/// A triangle as it is seen from a point, sampled uniformly by solid angle (Arvo 1995, "Stratified
/// Sampling of Spherical Triangles"; PBRT 6.5.4). In double, and with the solid angle from Van
/// Oosterom and Strackee (1983), so that it holds for triangles of 1e-4 rad too.
class SphericalTriangle {
 public:
  SphericalTriangle(Vec3f p0, Vec3f p1, Vec3f p2, Vec3f from)
      : to0_(ToDouble(p0) - ToDouble(from)),
        to1_(ToDouble(p1) - ToDouble(from)),
        to2_(ToDouble(p2) - ToDouble(from)),
        a_(Normalize(to0_)),
        b_(Normalize(to1_)),
        c_(Normalize(to2_)) {
    const double volume = std::fabs(Dot(a_, Cross(b_, c_)));
    solid_angle_ = AngleOf(a_, b_, c_);
    const double alpha = Atan2(volume, Dot(Cross(a_, b_), Cross(a_, c_)));
    sin_alpha_ = Sin(alpha);
    cos_alpha_ = Cos(alpha);
    alpha_ = alpha;
    cos_ab_ = Dot(a_, b_);
  }

  /// Of a point in the triangle's plane 0, or 2 pi within the triangle; NaN at a corner.
  double solid_angle() const { return solid_angle_; }
  /// Density by solid angle of every direction to the triangle.
  float Pdf() const { return static_cast<float>(1 / solid_angle_); }

  /// A direction (unit) from the point to the triangle; the solid angle is positive.
  Vec3f Sample(Vec2f u) const {
    // The corner C' of the part of the triangle that has u.x of its solid angle, on the arc AC.
    const double part = u.x * solid_angle_;
    const double s = Sin(part - alpha_), t = Cos(part - alpha_);
    const double du = t - cos_alpha_, dv = s + sin_alpha_ * cos_ab_;
    const double denominator = (dv * s + du * t) * sin_alpha_;
    // At part 0 it is A itself.
    const double q =
        denominator != 0
            ? std::clamp(((dv * t - du * s) * cos_alpha_ - dv) / denominator, -1.0, 1.0)
            : 1;
    const Vec3d corner = a_ * q + Orthogonal(c_, a_) * std::sqrt(std::max(0.0, 1 - q * q));
    // A point of the arc BC', uniform by the area it sweeps.
    const double z = 1 - u.y * OneMinusDot(corner, b_);
    return ToFloat(b_ * z + Orthogonal(corner, b_) * std::sqrt(std::max(0.0, (1 - z) * (1 + z))));
  }

  /// The weights of the second and third corner of the point that `w` meets, a direction to the
  /// triangle, whose plane the point does not lie in: not negative, their sum at most 1.
  Vec2f WeightsOf(Vec3f w) const {
    const Vec3d d = ToDouble(w);
    const double v0 = std::fabs(Dot(d, Cross(to1_, to2_))),
                 v1 = std::fabs(Dot(d, Cross(to0_, to2_))),
                 v2 = std::fabs(Dot(d, Cross(to0_, to1_)));
    const double scale = 1 / (v0 + v1 + v2);
    return {static_cast<float>(v1 * scale), static_cast<float>(v2 * scale)};
  }

  /// The u that Sample takes to `w`, a direction to the triangle's inside.
  Vec2f Invert(Vec3f w) const {
    const Vec3d p = Normalize(ToDouble(w));
    // Where the great circle through B and w meets the arc AC.
    Vec3d corner = Cross(Cross(b_, p), Cross(c_, a_));
    if (!(Length(corner) > 0)) return {0, 0};
    corner = Normalize(corner);
    if (Dot(corner, a_ + c_) < 0) corner = -corner;
    return {static_cast<float>(std::clamp(AngleOf(a_, b_, corner) / solid_angle_, 0.0, 1.0)),
            static_cast<float>(std::clamp(OneMinusDot(p, b_) / OneMinusDot(corner, b_), 0.0, 1.0))};
  }

 private:
  /// The solid angle between three unit vectors.
  static double AngleOf(Vec3d a, Vec3d b, Vec3d c) {
    return 2 * Atan2(std::fabs(Dot(a, Cross(b, c))), 1 + Dot(a, b) + Dot(b, c) + Dot(c, a));
  }
  /// 1 - a . b of unit vectors, without cancellation.
  static double OneMinusDot(Vec3d a, Vec3d b) { return 0.5 * Dot(a - b, a - b); }
  /// The unit vector along the part of v that is orthogonal to `axis`.
  static Vec3d Orthogonal(Vec3d v, Vec3d axis) {
    const Vec3d part = v - axis * Dot(v, axis);
    const double length = Length(part);
    return length > 0 ? part * (1 / length) : part;
  }

  Vec3d to0_, to1_, to2_;  ///< From the point to the corners,
  Vec3d a_, b_, c_;        ///< of unit length.
  double solid_angle_ = 0;
  double alpha_ = 0, sin_alpha_ = 0, cos_alpha_ = 1;  ///< The angle at A.
  double cos_ab_ = 1;                                 ///< Of the side AB.
};

}  // namespace strata
