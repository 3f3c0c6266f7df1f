#pragma once

#include <cmath>
#include <numbers>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/coat.h"
#include "worker/sampling/warp.h"

namespace strata {

/// A dielectric coat over a Lambertian base, the same on both sides, in closed form: what the
/// border lets in is scattered by the base, and the light that the border sends back down is summed
/// as a geometric series,
///
///   f = border + (1 - E(wo)) (1 - E(wi)) rho / (pi eta^2 (1 - rho R)),   R = 1 - (1 - mean E) /
///   eta^2
///
/// with E the border's albedo from outside and R that from below (docs/materials.md). A white base
/// under a clear coat loses nothing.
struct CoatedDiffuseBsdf {
  Coat coat;
  Rgb base;                 ///< All of the second term but its two directional factors.
  float mean_entering = 1;  ///< 1 - mean E.

  CoatedDiffuseBsdf() = default;
  CoatedDiffuseBsdf(const Coat& c, Rgb reflectance) : coat(c) {
    const float eta = coat.interface->eta();
    mean_entering = 1 - coat.interface->MeanReflectance(coat.Alpha());
    const Rgb series = Rgb::Gray(1) - reflectance * InternalReflectance();
    base = reflectance * (kInvPi / (eta * eta)) / series;
  }

  /// R, less what the layer takes on the way.
  Rgb InternalReflectance() const {
    const float eta = coat.interface->eta();
    return (1 - mean_entering / (eta * eta)) *
           CoatTransmittance(coat.optical_depth, 2 * coat.interface->internal_path());
  }

  /// Albedo of the light that comes from the base.
  Rgb BaseAlbedo(const CoatDirection& o) const {
    return base * (kPi * (1 - o.reflectance) * mean_entering) *
           CoatTransmittance(coat.optical_depth,
                             1 / o.cos_refracted + coat.interface->escaping_path());
  }
  /// The part of samples that go to the border's reflection.
  float BorderProbability(const CoatDirection& o) const {
    const float base_albedo = MaxComponent(BaseAlbedo(o));
    return base_albedo > 0 ? o.reflectance / (o.reflectance + base_albedo) : 1;
  }
};

inline bool IsDelta(const CoatedDiffuseBsdf& bsdf) {
  return bsdf.coat.IsSmooth() && IsBlack(bsdf.base);
}
inline bool HasDelta(const CoatedDiffuseBsdf& bsdf) { return bsdf.coat.IsSmooth(); }

namespace coated_diffuse_detail {

/// Both continuous parts at once, for directions above the surface.
inline BsdfValue Scatter(const CoatedDiffuseBsdf& bsdf, const CoatDirection& o,
                         float border_probability, Vec3f wo, Vec3f wi) {
  const CoatDirection i = EnterCoat(bsdf.coat, wi.z);
  BsdfValue result;
  result.f = bsdf.base * ((1 - o.reflectance) * (1 - i.reflectance) * wi.z) *
             CoatTransmittance(bsdf.coat.optical_depth, 1 / o.cos_refracted + 1 / i.cos_refracted);
  result.pdf = (1 - border_probability) * CosineHemispherePdf(wi.z);
  if (!bsdf.coat.IsSmooth()) {
    result.f += Rgb::Gray(EvalCoatBorder(bsdf.coat, wo, wi));
    result.pdf += border_probability * CoatBorderPdf(bsdf.coat, wo, wi);
  }
  return result;
}

/// The pair on the upper side; none when it lies on two sides or grazes the surface.
inline bool TurnUp(Vec3f& wo, Vec3f& wi) {
  if (!(wo.z * wi.z > 0)) return false;
  wo.z = std::fabs(wo.z);
  wi.z = std::fabs(wi.z);
  return true;
}

}  // namespace coated_diffuse_detail

inline Rgb Eval(const CoatedDiffuseBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!coated_diffuse_detail::TurnUp(wo, wi)) return {};
  const CoatDirection o = EnterCoat(bsdf.coat, wo.z);
  return coated_diffuse_detail::Scatter(bsdf, o, 0, wo, wi).f;
}

inline float Pdf(const CoatedDiffuseBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!coated_diffuse_detail::TurnUp(wo, wi)) return 0;
  const float border = bsdf.BorderProbability(EnterCoat(bsdf.coat, wo.z));
  const float base_pdf = (1 - border) * CosineHemispherePdf(wi.z);
  return bsdf.coat.IsSmooth() ? base_pdf : base_pdf + border * CoatBorderPdf(bsdf.coat, wo, wi);
}

inline BsdfValue EvalPdf(const CoatedDiffuseBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (!coated_diffuse_detail::TurnUp(wo, wi)) return {};
  const CoatDirection o = EnterCoat(bsdf.coat, wo.z);
  return coated_diffuse_detail::Scatter(bsdf, o, bsdf.BorderProbability(o), wo, wi);
}

inline std::optional<BsdfSample> Sample(const CoatedDiffuseBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f u) {
  if (wo.z == 0) return std::nullopt;
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const CoatDirection o = EnterCoat(bsdf.coat, upper.z);
  const float border = bsdf.BorderProbability(o);
  Vec3f wi;
  if (u_lobe < border) {
    if (bsdf.coat.IsSmooth()) {
      return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                        .weight = Rgb::Gray(o.reflectance / border),
                        .pdf = border,
                        .delta = true};
    }
    wi = Reflect(upper, bsdf.coat.ggx.SampleVisibleNormal(upper, u));
  } else {
    wi = SampleCosineHemisphere(u);
  }
  if (!(wi.z > 0)) return std::nullopt;
  const auto [f, pdf] = coated_diffuse_detail::Scatter(bsdf, o, border, upper, wi);
  if (!(pdf > 0)) return std::nullopt;
  wi.z = std::copysign(wi.z, wo.z);
  return BsdfSample{.wi = wi, .weight = f / pdf, .pdf = pdf};
}

inline Rgb Albedo(const CoatedDiffuseBsdf& bsdf, Vec3f wo) {
  const CoatDirection o = EnterCoat(bsdf.coat, std::fabs(wo.z));
  return Rgb::Gray(o.reflectance) + bsdf.BaseAlbedo(o);
}

}  // namespace strata
