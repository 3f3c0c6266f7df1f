#pragma once

#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/fresnel.h"
#include "worker/bsdf/ggx.h"

namespace strata {

/// A metal of complex index eta + i k for each channel, smooth (PBRT 9.4) or with GGX microfacets
/// (PBRT 9.6.5); the same on both sides. Light that microfacets would pass on to each other is lost
/// (single scattering).
struct ConductorBsdf {
  Rgb eta, k;
  Ggx ggx;
};

inline bool IsDelta(const ConductorBsdf& bsdf) { return bsdf.ggx.IsSmooth(); }
inline bool HasDelta(const ConductorBsdf& bsdf) { return IsDelta(bsdf); }

inline Rgb Eval(const ConductorBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!(wo.z * wi.z > 0) || bsdf.ggx.IsSmooth()) return {};
  const Vec3f m = Normalize(wo + wi);
  const Rgb fresnel = FresnelConductor(Min(AbsDot(wo, m), 1.0f), bsdf.eta, bsdf.k);
  return fresnel * (bsdf.ggx.D(m) * bsdf.ggx.VisibilityOver4(wo, wi) * std::fabs(wi.z));
}

inline float Pdf(const ConductorBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!(wo.z * wi.z > 0) || bsdf.ggx.IsSmooth()) return 0;
  return 0.25f * bsdf.ggx.VisibleNormalPdfOverCos(wo, Normalize(wo + wi));
}

inline std::optional<BsdfSample> Sample(const ConductorBsdf& bsdf, Vec3f wo, float, Vec2f u) {
  if (wo.z == 0) return std::nullopt;
  if (bsdf.ggx.IsSmooth()) {
    return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                      .weight = FresnelConductor(std::fabs(wo.z), bsdf.eta, bsdf.k),
                      .pdf = 1,
                      .delta = true};
  }
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const Vec3f m = bsdf.ggx.SampleVisibleNormal(upper, u);
  Vec3f wi = Reflect(upper, m);
  if (!(wi.z > 0)) return std::nullopt;
  const Rgb fresnel = FresnelConductor(Min(AbsDot(upper, m), 1.0f), bsdf.eta, bsdf.k);
  const Rgb weight = fresnel * bsdf.ggx.MaskingRatio(upper, wi);
  const float pdf = 0.25f * bsdf.ggx.VisibleNormalPdfOverCos(upper, m);
  wi.z = std::copysign(wi.z, wo.z);
  return BsdfSample{.wi = wi, .weight = weight, .pdf = pdf};
}

/// That of the smooth metal, an upper bound: at alpha 1 and normal incidence single scattering
/// returns but 1 - ln 2 of it.
inline Rgb Albedo(const ConductorBsdf& bsdf, Vec3f wo) {
  return FresnelConductor(std::fabs(wo.z), bsdf.eta, bsdf.k);
}

}  // namespace strata
