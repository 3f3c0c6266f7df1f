#pragma once

#include <absl/container/inlined_vector.h>

#include <optional>

#include "worker/math/vec3d.h"

namespace strata {

/// A flat lamp and a smooth ball of glass beside it.
struct LampInBall {
  Vec3d center;
  double radius = 0;
  double eta = 1;              ///< Within the ball over without.
  Vec3d corner, edge1, edge2;  ///< The lamp: corner + a edge1 + b edge2 for 0 <= a, b <= 1,
  bool triangle = false;       ///< and, if a triangle, a + b <= 1.
  Vec3d ng;                    ///< Unit, of the lamp's emitting side.
  bool two_sided = false;
  float luminance = 0;  ///< Of its radiance.

  double Area() const;
  double SolidAngle() const;  ///< About what it fills at most of what the ball's centre sees.
  /// For u in [0, 1)^2 uniform by area.
  Vec3d Point(double u, double v) const;
  Vec3d Middle() const;
};

inline constexpr int kMaxChords = 2;

/// A way from a point by the ball to a point of the lamp. Within the ball it has no chord if it is
/// reflected outside, one if it goes through, two if it is reflected once within; ways with more
/// are left to chance.
struct BallPath {
  Vec3d direction;       ///< In which it leaves the point; unit.
  double density = 0;    ///< Area of the lamp per solid angle of the direction.
  double amplitude = 0;  ///< Square root of what the borders reflect and let pass on this way.

  /// Square root of the second moment of what the path brings, where borders reflect or let pass by
  /// chance, and up to what the lamp is: paths should be chosen in proportion.
  double Strength() const { return amplitude / density; }
};
using BallPaths = absl::InlinedVector<BallPath, 4>;

/// All of `chords` from `p` to a point of the lamp, both outside of the ball. None at caustics.
///
/// In the plane of both points and the centre a path turns about the centre by
///   2 i - asin(b R / d_p) - asin(b R / d_q) + chords (pi - 2 asin(b / eta)),
/// where i is the angle of incidence, the same at every border, b = sin i, R the radius and d_p
/// and d_q the points' distances from the centre. It is solved for i; the density is its derivative
/// (as manifold next-event estimation has it: Hanika, Droske and Fascione 2015).
BallPaths FindBallPaths(const LampInBall& lamp, int chords, Vec3d p, Vec3d lamp_point);
/// Where a ray from `p` that is reflected and refracted so meets the lamp; none if it does not.
std::optional<Vec3d> LampPointBy(const LampInBall& lamp, int chords, Vec3d p, Vec3d direction);

}  // namespace strata
