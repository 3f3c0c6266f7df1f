#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/fresnel.h"
#include "worker/bsdf/power_cosine.h"

namespace strata {

/// Torrance and Sparrow's microfacets with Blinn's distribution D = (n + 2) / (2 pi) cos^n and
/// masking by V-shaped cavities (PBRT 2nd ed. 8.4.2), of a metal, or of a dielectric (k = 0) that
/// absorbs what it does not reflect; the same on both sides. Light scatters once: what facets would
/// pass on to each other is lost.
struct BlinnBsdf {
  Rgb eta, k;
  float exponent = 0;  ///< n, 0 or more.

  PowerCosine normals() const { return {exponent, exponent}; }
};

namespace blinn_detail {

/// G / (4 cos_o): masking and shadowing by the cavity, min(1, 2 m.z o / (o . m), 2 m.z i / (o .
/// m)).
inline float Visibility(float cos_o, float cos_i, float cos_m, float o_dot_m) {
  const float open = 0.25f / cos_o;
  const float closed = 0.5f * cos_m * std::min(1.0f, cos_i / cos_o) / o_dot_m;
  return std::min(open, closed);
}

/// For directions above the surface.
inline BsdfValue Scatter(const BlinnBsdf& bsdf, Vec3f wo, Vec3f wi) {
  const Vec3f m = Normalize(wo + wi);
  const float o_dot_m = std::min(Dot(wo, m), 1.0f);
  if (!(o_dot_m > 0)) return {};
  const float power = bsdf.normals().Power(m);
  const float d = (bsdf.exponent + 2) * (0.5f * kInvPi) * power;
  return {FresnelConductor(o_dot_m, bsdf.eta, bsdf.k) * (d * Visibility(wo.z, wi.z, m.z, o_dot_m)),
          (bsdf.exponent + 1) * (0.125f * kInvPi) * power / o_dot_m};
}

}  // namespace blinn_detail

inline bool IsDelta(const BlinnBsdf&) { return false; }

inline BsdfValue EvalPdf(const BlinnBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!(wo.z * wi.z > 0)) return {};
  wo.z = std::fabs(wo.z);
  wi.z = std::fabs(wi.z);
  return blinn_detail::Scatter(bsdf, wo, wi);
}
inline Rgb Eval(const BlinnBsdf& bsdf, Vec3f wo, Vec3f wi) { return EvalPdf(bsdf, wo, wi).f; }
inline float Pdf(const BlinnBsdf& bsdf, Vec3f wo, Vec3f wi) { return EvalPdf(bsdf, wo, wi).pdf; }

inline std::optional<BsdfSample> Sample(const BlinnBsdf& bsdf, Vec3f wo, float, Vec2f u) {
  if (wo.z == 0) return std::nullopt;
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const Vec3f m = bsdf.normals().Sample(u);
  if (!(Dot(upper, m) > 0)) return std::nullopt;
  Vec3f wi = Reflect(upper, m);
  if (!(wi.z > 0)) return std::nullopt;
  const BsdfValue value = blinn_detail::Scatter(bsdf, upper, wi);
  if (!(value.pdf > 0)) return std::nullopt;
  wi.z = std::copysign(wi.z, wo.z);
  return BsdfSample{.wi = wi, .weight = value.f / value.pdf, .pdf = value.pdf};
}

/// That of a smooth surface: about an upper bound, since it leaves out what scattering once loses.
inline Rgb Albedo(const BlinnBsdf& bsdf, Vec3f wo) {
  return FresnelConductor(std::fabs(wo.z), bsdf.eta, bsdf.k);
}

}  // namespace strata
