#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"

// Maps of the unit square that keep uniform points uniform with respect to some measure (PBRT A.5).
// Each stands beside its density. Local directions have their axis along z.

namespace strata {

/// Point of the unit disk, uniform by area (Shirley and Chiu 1997: little distortion; PBRT A.5.1).
inline Vec2f SampleConcentricDisk(Vec2f u) {
  const float a = 2 * u.x - 1, b = 2 * u.y - 1;
  const bool a_larger = std::fabs(a) > std::fabs(b);
  const float radius = a_larger ? a : b;
  const float other = a_larger ? b : a;
  const float eighths = radius != 0 ? other / radius : 0;
  const SinCosResult<float> angle = SinCosWithinEighth(0.125f * eighths);
  return a_larger ? Vec2f{radius * angle.cos, radius * angle.sin}
                  : Vec2f{radius * angle.sin, radius * angle.cos};
}
inline constexpr float ConcentricDiskPdf() { return kInvPi; }

/// The direction of the upper hemisphere over a point of the unit disk.
inline Vec3f LiftFromDisk(Vec2f d) {
  return {d.x, d.y, std::sqrt(std::max(0.0f, Fma(-d.x, d.x, Fma(-d.y, d.y, 1))))};
}
/// Direction of the upper hemisphere, by projected solid angle (Malley's method, PBRT A.5.3).
inline Vec3f SampleCosineHemisphere(Vec2f u) { return LiftFromDisk(SampleConcentricDisk(u)); }
inline float CosineHemispherePdf(float cos_theta) { return std::max(0.0f, cos_theta) * kInvPi; }

/// The direction about z with 1 - cos(theta) given, at `turn` of a full turn. Keeps its accuracy
/// for the smallest angles.
inline Vec3f DirectionFromOneMinusCos(float one_minus_cos, float turn) {
  const float sin_theta = std::sqrt(std::max(0.0f, one_minus_cos * (2 - one_minus_cos)));
  const SinCosResult<float> phi = SinCos2Pi(turn);
  return {sin_theta * phi.cos, sin_theta * phi.sin, 1 - one_minus_cos};
}

/// Direction of the upper hemisphere, by solid angle (PBRT A.5.2).
inline Vec3f SampleUniformHemisphere(Vec2f u) { return DirectionFromOneMinusCos(1 - u.x, u.y); }
inline constexpr float UniformHemispherePdf() { return 0.5f * kInvPi; }

/// Direction of the whole sphere, by solid angle (PBRT A.5.2).
inline Vec3f SampleUniformSphere(Vec2f u) { return DirectionFromOneMinusCos(2 * u.x, u.y); }
inline constexpr float UniformSpherePdf() { return 0.25f * kInvPi; }

/// 1 - cos of the angle whose sine squared is given, for angles up to a right one.
inline float OneMinusCosFromSinSquared(float sin_squared) {
  return sin_squared / (1 + std::sqrt(std::max(0.0f, 1 - sin_squared)));
}

/// Direction of the cone about z that reaches to 1 - cos = `one_minus_cos_max`, by solid angle
/// (PBRT A.5.4).
inline Vec3f SampleUniformCone(Vec2f u, float one_minus_cos_max) {
  return DirectionFromOneMinusCos(u.x * one_minus_cos_max, u.y);
}
inline float UniformConePdf(float one_minus_cos_max) { return 0.5f * kInvPi / one_minus_cos_max; }

/// Weights of the first two corners of a triangle, uniform by area (Heitz 2019, "A Low-Distortion
/// Map Between Triangle and Square"; PBRT 6.5.4). The density is 1 / area.
inline Vec2f SampleTriangle(Vec2f u) {
  if (u.x > u.y) {
    const float b1 = 0.5f * u.y;
    return {u.x - b1, b1};
  }
  const float b0 = 0.5f * u.x;
  return {b0, u.y - b0};
}

/// Weight of a sample drawn from `pdf` when it could also have come from `other_pdf` (Veach 1997,
/// 9.2.4: power heuristic with beta 2, one sample each; PBRT 2.2.3). Safe for infinite and for huge
/// densities.
inline float PowerHeuristic(float pdf, float other_pdf) {
  if (!(pdf > 0)) return 0;
  const float ratio = other_pdf / pdf;
  return std::isnan(ratio) ? 0.5f : 1 / (1 + ratio * ratio);
}
/// The same with beta 1.
inline float BalanceHeuristic(float pdf, float other_pdf) {
  if (!(pdf > 0)) return 0;
  const float ratio = other_pdf / pdf;
  return std::isnan(ratio) ? 0.5f : 1 / (1 + ratio);
}

}  // namespace strata
