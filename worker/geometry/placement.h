#pragma once

#include <array>
#include <optional>

#include "worker/math/vec3d.h"

namespace strata {

/// An invertible affine map from an object's space to the world's, with its inverse.
struct Placement {
  /// Rows of (linear part | translation).
  using Rows = std::array<std::array<double, 4>, 3>;
  Rows to_world = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
  Rows to_object = to_world;
  double determinant = 1;  ///< Of the linear part of `to_world`.

  /// None when the map is singular, projective or not finite.
  static std::optional<Placement> From(const Transform& to_world);

  /// The factor by which all lengths scale when the map is a similarity; none otherwise.
  std::optional<double> UniformScale() const;

  static Vec3d Point(const Rows& m, Vec3d p) {
    return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
            m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
            m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
  }
  static Vec3d Vector(const Rows& m, Vec3d v) {
    return {m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z,
            m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
            m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
  }
  /// A normal in the world, not normalized: by the inverse transpose, so that it stays outside.
  Vec3d NormalToWorld(Vec3d n) const {
    const Rows& m = to_object;
    return {m[0][0] * n.x + m[1][0] * n.y + m[2][0] * n.z,
            m[0][1] * n.x + m[1][1] * n.y + m[2][1] * n.z,
            m[0][2] * n.x + m[1][2] * n.y + m[2][2] * n.z};
  }
  /// World area over object area on a surface with the unit object-space normal `n`.
  double AreaScale(Vec3d n) const { return std::abs(determinant) * Length(NormalToWorld(n)); }
  /// Sums of absolute terms of Point(to_world, p), which bound its rounding error.
  Vec3d PointMagnitude(Vec3d p) const {
    const auto row = [&](const std::array<double, 4>& r) {
      return std::abs(r[0] * p.x) + std::abs(r[1] * p.y) + std::abs(r[2] * p.z) + std::abs(r[3]);
    };
    return {row(to_world[0]), row(to_world[1]), row(to_world[2])};
  }
};

/// Takes the derivatives of a unit normal along with the normal itself.
class NormalDerivatives {
 public:
  /// `n` is the normal before, unit; `flipped` turns it to the other side as well.
  NormalDerivatives(const Placement& placement, Vec3d n, bool flipped)
      : placement_(placement), unit_(placement.NormalToWorld(n)) {
    const double length = Length(unit_);
    unit_ = unit_ * (1 / length);
    scale_ = (flipped ? -1 : 1) / length;
  }
  Vec3f operator()(Vec3d dn) const {
    const Vec3d d = placement_.NormalToWorld(dn);
    return ToFloat((d - unit_ * Dot(unit_, d)) * scale_);
  }

 private:
  const Placement& placement_;
  Vec3d unit_;
  double scale_;
};

}  // namespace strata
