#pragma once

#include <array>
#include <optional>

#include "worker/math/vec.h"

namespace strata {

struct Vec3d {
  double x = 0, y = 0, z = 0;
  bool operator==(const Vec3d&) const = default;
};

/// An affine or projective map in double, row-major, acting on column vectors: p' = M p.
struct Transform {
  std::array<std::array<double, 4>, 4> m = {
      {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}}};

  static Transform Translate(double x, double y, double z);
  static Transform Scale(double x, double y, double z);
  /// Counter-clockwise by `degrees` about the axis, which need not be of unit length.
  static Transform Rotate(double degrees, double x, double y, double z);
  /// World to camera for a camera at `eye` that looks at `look` (PBRT 3.9.3); none if degenerate.
  static std::optional<Transform> LookAt(Vec3d eye, Vec3d look, Vec3d up);
  /// pbrt's order: sixteen numbers column by column.
  static Transform FromColumns(const std::array<double, 16>& columns);

  Vec3d Point(Vec3d p) const;   ///< Divides by w.
  Vec3d Vector(Vec3d v) const;  ///< Linear part alone.
  /// Applies the inverse transpose of the linear part, given the inverse of this transform.
  static Vec3d Normal(const Transform& inverse, Vec3d n);
  /// None when singular.
  std::optional<Transform> Inverse() const;
  Transform Transposed() const;
  /// True when the linear part turns a right-handed system into a left-handed one.
  bool SwapsHandedness() const;
  bool IsFinite() const;

  friend Transform operator*(const Transform& a, const Transform& b);
  bool operator==(const Transform&) const = default;
};

}  // namespace strata
