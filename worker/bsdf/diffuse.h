#pragma once

#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/sampling/warp.h"

namespace strata {

/// Lambert's reflection, the same on both sides (PBRT 9.2).
struct DiffuseBsdf {
  Rgb reflectance;
};

inline bool IsDelta(const DiffuseBsdf&) { return false; }
inline bool HasDelta(const DiffuseBsdf&) { return false; }

inline Rgb Eval(const DiffuseBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!(wo.z * wi.z > 0)) return {};
  return bsdf.reflectance * (kInvPi * std::fabs(wi.z));
}

inline float Pdf(const DiffuseBsdf&, Vec3f wo, Vec3f wi) {
  return wo.z * wi.z > 0 ? CosineHemispherePdf(std::fabs(wi.z)) : 0;
}

inline std::optional<BsdfSample> Sample(const DiffuseBsdf& bsdf, Vec3f wo, float, Vec2f u) {
  Vec3f wi = SampleCosineHemisphere(u);
  const float pdf = CosineHemispherePdf(wi.z);
  if (wo.z < 0) wi.z = -wi.z;
  if (!(wo.z * wi.z > 0)) return std::nullopt;
  return BsdfSample{.wi = wi, .weight = bsdf.reflectance, .pdf = pdf};
}

inline Rgb Albedo(const DiffuseBsdf& bsdf, Vec3f) { return bsdf.reflectance; }

}  // namespace strata
