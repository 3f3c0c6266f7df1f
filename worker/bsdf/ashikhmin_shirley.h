#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/fresnel.h"
#include "worker/bsdf/power_cosine.h"
#include "worker/sampling/warp.h"

namespace strata {

/// Ashikhmin and Shirley's anisotropic Phong model (2000, JGT 5(2); PBRT 3rd ed. 8.5): a glossy
/// reflection with Schlick's Fresnel over a diffuse one that gets what is left, both reciprocal;
/// the same on both sides.
///
///   f = 28 Rd / (23 pi) (1 - Rs) g(o) g(i)
///     + sqrt((nu + 1)(nv + 1)) / (8 pi) cos^n(m) F(o . m) / ((o . m) max(o, i)),
///   g(c) = 1 - (1 - c/2)^5
struct AshikhminShirleyBsdf {
  Rgb diffuse, specular;  ///< Rd and Rs, in [0, 1].
  PowerCosine normals;

  /// Albedo of the diffuse part, exact.
  Rgb DiffuseAlbedo(float cos_theta) const;
  /// Of choosing the glossy part.
  float SpecularProbability(float cos_theta) const;
};

namespace ashikhmin_shirley_detail {

inline float Fifth(float x) { return (x * x) * (x * x) * x; }
/// Schlick's approximation (1994, CGF 13(3)).
inline Rgb Fresnel(Rgb at_normal, float cosine) {
  return at_normal + (Rgb::Gray(1) - at_normal) * Fifth(1 - cosine);
}
inline float Falloff(float cosine) { return 1 - Fifth(1 - 0.5f * cosine); }

/// For directions above the surface.
inline BsdfValue Scatter(const AshikhminShirleyBsdf& bsdf, float specular_probability, Vec3f wo,
                         Vec3f wi) {
  BsdfValue value;
  value.f = bsdf.diffuse * (Rgb::Gray(1) - bsdf.specular) *
            (28 / 23.0f * kInvPi * Falloff(wo.z) * Falloff(wi.z) * wi.z);
  value.pdf = (1 - specular_probability) * CosineHemispherePdf(wi.z);
  const Vec3f m = Normalize(wo + wi);
  const float o_dot_m = std::min(Dot(wo, m), 1.0f);
  if (!(o_dot_m > 0)) return value;
  // Of the reflected direction, were it sampled by its half vector alone.
  const float reflected = 0.25f * bsdf.normals.Pdf(m) / o_dot_m;
  value.f += Fresnel(bsdf.specular, o_dot_m) * (reflected * wi.z / std::max(wo.z, wi.z));
  value.pdf += specular_probability * reflected;
  return value;
}

}  // namespace ashikhmin_shirley_detail

inline Rgb AshikhminShirleyBsdf::DiffuseAlbedo(float cos_theta) const {
  return diffuse * (Rgb::Gray(1) - specular) * ashikhmin_shirley_detail::Falloff(cos_theta);
}
inline float AshikhminShirleyBsdf::SpecularProbability(float cos_theta) const {
  const float glossy = MaxComponent(ashikhmin_shirley_detail::Fresnel(specular, cos_theta));
  return glossy / (glossy + MaxComponent(DiffuseAlbedo(cos_theta)));
}

inline bool IsDelta(const AshikhminShirleyBsdf&) { return false; }

inline BsdfValue EvalPdf(const AshikhminShirleyBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!(wo.z * wi.z > 0)) return {};
  wo.z = std::fabs(wo.z);
  wi.z = std::fabs(wi.z);
  return ashikhmin_shirley_detail::Scatter(bsdf, bsdf.SpecularProbability(wo.z), wo, wi);
}
inline Rgb Eval(const AshikhminShirleyBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return EvalPdf(bsdf, wo, wi).f;
}
inline float Pdf(const AshikhminShirleyBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return EvalPdf(bsdf, wo, wi).pdf;
}

inline std::optional<BsdfSample> Sample(const AshikhminShirleyBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f u) {
  if (wo.z == 0) return std::nullopt;
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const float glossy = bsdf.SpecularProbability(upper.z);
  Vec3f wi;
  if (u_lobe < glossy) {
    const Vec3f m = bsdf.normals.Sample(u);
    if (!(Dot(upper, m) > 0)) return std::nullopt;
    wi = Reflect(upper, m);
  } else {
    wi = SampleCosineHemisphere(u);
  }
  if (!(wi.z > 0)) return std::nullopt;
  const BsdfValue value = ashikhmin_shirley_detail::Scatter(bsdf, glossy, upper, wi);
  if (!(value.pdf > 0)) return std::nullopt;
  wi.z = std::copysign(wi.z, wo.z);
  return BsdfSample{.wi = wi, .weight = value.f / value.pdf, .pdf = value.pdf};
}

/// Exact for the diffuse part; for the glossy one that of a smooth surface.
inline Rgb Albedo(const AshikhminShirleyBsdf& bsdf, Vec3f wo) {
  const float cosine = std::fabs(wo.z);
  return bsdf.DiffuseAlbedo(cosine) + ashikhmin_shirley_detail::Fresnel(bsdf.specular, cosine);
}

}  // namespace strata
