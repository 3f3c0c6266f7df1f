#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"
#include "worker/scene/description.h"

// How the directions around a scene lie in the unit square of an environment image. (0, 0) is the
// outer corner of the image's first pixel, the second coordinate grows downwards.

namespace strata {

/// Clarberg 2008, "Fast equal-area mapping of the (hemi)sphere using SIMD": octants of the sphere
/// become triangles of the square, z up in its middle.
inline Vec3f EqualAreaSquareToSphere(Vec2f st) {
  const float u = 2 * st.x - 1, v = 2 * st.y - 1;
  const float signed_distance = 1 - (std::abs(u) + std::abs(v));
  const float r = 1 - std::abs(signed_distance);
  const float octant = r == 0 ? 1 : (std::abs(v) - std::abs(u)) / r + 1;
  const auto [sin_phi, cos_phi] = SinCos2Pi(octant * 0.125f);
  const float sin_theta = r * std::sqrt(2 - r * r);
  return {std::copysign(cos_phi, u) * sin_theta, std::copysign(sin_phi, v) * sin_theta,
          std::copysign(1 - r * r, signed_distance)};
}

inline Vec2f EqualAreaSphereToSquare(Vec3f d) {
  const float x = std::abs(d.x), y = std::abs(d.y);
  // sqrt(1 - |z|) without the cancellation near the poles.
  const float r = std::sqrt((x * x + y * y) / (1 + std::abs(d.z)));
  const float quadrant = Atan2(y, x) * (2 * kInvPi);
  float v = quadrant * r;
  float u = r - v;
  if (d.z < 0) {
    std::swap(u, v);
    u = 1 - u;
    v = 1 - v;
  }
  return {0.5f * (std::copysign(u, d.x) + 1), 0.5f * (std::copysign(v, d.y) + 1)};
}

/// Columns are longitudes from +x towards +y, rows colatitudes from +z.
inline Vec3f LatLongSquareToSphere(Vec2f st) {
  const auto [sin_theta, cos_theta] = SinCos2Pi(0.5f * st.y);
  const auto [sin_phi, cos_phi] = SinCos2Pi(st.x);
  return {sin_theta * cos_phi, sin_theta * sin_phi, cos_theta};
}

inline Vec2f LatLongSphereToSquare(Vec3f d) {
  const float longitude = Atan2(d.y, d.x) * (0.5f * kInvPi);
  const float colatitude = Atan2(std::sqrt(d.x * d.x + d.y * d.y), d.z) * kInvPi;
  return {longitude < 0 ? longitude + 1 : longitude, colatitude};
}

inline Vec3f SquareToSphere(EnvironmentMapping mapping, Vec2f st) {
  return mapping == EnvironmentMapping::kEqualArea ? EqualAreaSquareToSphere(st)
                                                   : LatLongSquareToSphere(st);
}
inline Vec2f SphereToSquare(EnvironmentMapping mapping, Vec3f d) {
  return mapping == EnvironmentMapping::kEqualArea ? EqualAreaSphereToSquare(d)
                                                   : LatLongSphereToSquare(d);
}

/// Solid angle per area of the square around direction `d`.
inline float SphereDensity(EnvironmentMapping mapping, Vec3f d) {
  if (mapping == EnvironmentMapping::kEqualArea) return 4 * kPi;
  return 2 * kPi * kPi * std::sqrt(d.x * d.x + d.y * d.y);
}

}  // namespace strata
