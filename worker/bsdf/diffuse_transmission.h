#pragma once

#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/sampling/warp.h"

namespace strata {

/// Lambert's reflection (PBRT 9.2) on the side of the viewer and the like through to the other
/// side. Their sum is the caller's to keep at or below 1.
struct DiffuseTransmissionBsdf {
  Rgb reflectance, transmittance;

  /// Of choosing the reflected side; 0 when nothing scatters.
  float ReflectionProbability() const {
    const float r = MaxComponent(reflectance), t = MaxComponent(transmittance);
    return r > 0 ? r / (r + t) : 0;
  }
};

inline bool IsDelta(const DiffuseTransmissionBsdf&) { return false; }
inline bool HasDelta(const DiffuseTransmissionBsdf&) { return false; }

inline Rgb Eval(const DiffuseTransmissionBsdf& bsdf, Vec3f wo, Vec3f wi) {
  const float sides = wo.z * wi.z;
  if (sides == 0) return {};
  return (sides > 0 ? bsdf.reflectance : bsdf.transmittance) * (kInvPi * std::fabs(wi.z));
}

inline float Pdf(const DiffuseTransmissionBsdf& bsdf, Vec3f wo, Vec3f wi) {
  const float sides = wo.z * wi.z;
  if (sides == 0 || (IsBlack(bsdf.reflectance) && IsBlack(bsdf.transmittance))) return 0;
  const float reflect = bsdf.ReflectionProbability();
  return (sides > 0 ? reflect : 1 - reflect) * CosineHemispherePdf(std::fabs(wi.z));
}

inline std::optional<BsdfSample> Sample(const DiffuseTransmissionBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f u) {
  if (IsBlack(bsdf.reflectance) && IsBlack(bsdf.transmittance)) return std::nullopt;
  const float reflect = bsdf.ReflectionProbability();
  const bool transmission = u_lobe >= reflect;
  const float probability = transmission ? 1 - reflect : reflect;
  Vec3f wi = SampleCosineHemisphere(u);
  if (wi.z == 0 || wo.z == 0) return std::nullopt;
  const float pdf = probability * CosineHemispherePdf(wi.z);
  if ((wo.z < 0) != transmission) wi.z = -wi.z;
  return BsdfSample{.wi = wi,
                    .weight = (transmission ? bsdf.transmittance : bsdf.reflectance) / probability,
                    .pdf = pdf,
                    .transmission = transmission};
}

inline Rgb Albedo(const DiffuseTransmissionBsdf& bsdf, Vec3f) {
  return bsdf.reflectance + bsdf.transmittance;
}

}  // namespace strata
