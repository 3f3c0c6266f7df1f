#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/lanes.h"

namespace strata {

/// What a smooth border between two dielectrics does to unpolarized light (PBRT 9.3.5), once or
/// eight times.
template <typename Float>
struct DielectricFresnelOf {
  Float reflectance;    ///< The rest is transmitted.
  Float cos_refracted;  ///< Of the refracted ray, >= 0; 0 when all is reflected.
};
using DielectricFresnel = DielectricFresnelOf<float>;

/// Its cos_refracted alone.
template <typename Float>
Float CosRefracted(Float cos_incident, Float eta) {
  const Float sin2_incident = Max(Float{}, (1 - cos_incident) * (1 + cos_incident));
  const Float cos_refracted = Sqrt(Max(Float{}, 1 - sin2_incident / (eta * eta)));
  return eta == 1 ? cos_incident : cos_refracted;
}

/// `cos_incident` in [0, 1]; `eta` is the index behind the border over that before it.
template <typename Float>
DielectricFresnelOf<Float> FresnelDielectric(Float cos_incident, Float eta) {
  const Float cos_refracted = CosRefracted(cos_incident, eta);
  const Float parallel =
      (eta * cos_incident - cos_refracted) / (eta * cos_incident + cos_refracted);
  const Float perpendicular =
      (cos_incident - eta * cos_refracted) / (cos_incident + eta * cos_refracted);
  const Float reflectance = 0.5f * (parallel * parallel + perpendicular * perpendicular);
  // Beyond the critical angle both quotients are 1. At grazing angles they may be 0 / 0.
  const Float partly = eta * cos_incident == 0 ? Float{} + 1 : reflectance;
  return {eta == 1 ? Float{} : partly, cos_refracted};
}

/// Reflectance of a metal of index eta + i k (both relative to the medium before it), one channel
/// (Born and Wolf, Principles of Optics, 14.2; PBRT 9.3.6). `cos_incident` in [0, 1].
inline float FresnelConductor(float cos_incident, float eta, float k) {
  const float cos2 = cos_incident * cos_incident;
  const float sin2 = 1 - cos2;
  const float eta2 = eta * eta, k2 = k * k;
  const float t0 = eta2 - k2 - sin2;
  const float a2_plus_b2 = std::sqrt(t0 * t0 + 4 * eta2 * k2);
  const float a = std::sqrt(std::max(0.0f, 0.5f * (a2_plus_b2 + t0)));
  const float s0 = a2_plus_b2 + cos2;
  const float s1 = 2 * a * cos_incident;
  const float perpendicular = (s0 - s1) / (s0 + s1);
  const float p0 = cos2 * a2_plus_b2 + sin2 * sin2;
  const float p1 = s1 * sin2;
  const float parallel = perpendicular * (p0 - p1) / (p0 + p1);
  return 0.5f * (perpendicular + parallel);
}

inline Rgb FresnelConductor(float cos_incident, Rgb eta, Rgb k) {
  return {FresnelConductor(cos_incident, eta.r, k.r), FresnelConductor(cos_incident, eta.g, k.g),
          FresnelConductor(cos_incident, eta.b, k.b)};
}

/// Mirror image of w about m, which is unit.
template <typename Vec3>
Vec3 Reflect(Vec3 w, Vec3 m) {
  return m * (2 * Dot(w, m)) - w;
}

}  // namespace strata
