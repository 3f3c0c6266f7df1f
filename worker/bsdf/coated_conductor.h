#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/coat.h"

namespace strata {

/// A dielectric coat over a metal, the same on both sides, in closed form: light is refracted into
/// the coat, reflected by the metal there, and refracted out; what the border sends back down is
/// summed as a geometric series around the same pair of directions,
///
///   f = border + (1 - E(wo)) (1 - E(wi)) f_metal(wo', wi') / (eta^2 (1 - min(E(wo), E(wi)) F))
///
/// with E the border's albedo, F the metal's Fresnel reflectance and ' the refracted directions
/// (docs/materials.md). Exact when both are smooth; otherwise never more than all energy.
struct CoatedConductorBsdf {
  Coat coat;
  Rgb eta, k;  ///< Of the metal relative to the coat.
  Ggx metal;   ///< With the spread that a rough border adds to what passes it twice.

  CoatedConductorBsdf() = default;
  CoatedConductorBsdf(const Coat& c, Rgb metal_eta, Rgb metal_k, Ggx ggx)
      : coat(c), eta(metal_eta), k(metal_k), metal(ggx) {
    if (coat.IsSmooth()) return;
    // A border tilted by h turns what passes it by (1 - 1/eta) h, as a metal tilted by half of
    // that would; the two passages are independent.
    const float turn = 1 - 1 / coat.interface->eta();
    const float spread = 0.5f * turn * turn;
    const auto widen = [&](float alpha, float border) {
      return std::max(std::sqrt(alpha * alpha + spread * border * border), 1e-3f);
    };
    metal = {widen(ggx.alpha_x, coat.ggx.alpha_x), widen(ggx.alpha_y, coat.ggx.alpha_y)};
  }

  /// What the metal returns at the cosine of its own microfacets, internal reflections included.
  Rgb Series(float cos_metal, float length, float returned) const {
    const Rgb transmittance = CoatTransmittance(coat, length);
    const Rgb once = FresnelConductor(std::fmin(cos_metal, 1.0f), eta, k) * transmittance;
    return once / (Rgb::Gray(1) - once * returned);
  }

  /// Light that comes back from the metal, as if it were smooth.
  Rgb MetalAlbedo(const CoatDirection& o) const {
    const float entering = 1 - o.reflectance;
    return Series(o.cos_refracted, 2 / o.cos_refracted, o.reflectance) * (entering * entering);
  }
  float BorderProbability(const CoatDirection& o) const {
    return o.reflectance / (o.reflectance + MaxComponent(MetalAlbedo(o)));
  }
};

/// The metal is never smooth under a rough border, so this is all or one of two parts.
inline bool IsDelta(const CoatedConductorBsdf& bsdf) {
  return bsdf.coat.IsSmooth() && bsdf.metal.IsSmooth();
}

namespace coated_conductor_detail {

/// An upper direction as it goes on inside the coat, still pointing away from the metal.
inline Vec3f Refracted(Vec3f w, float eta, float cos_refracted) {
  return {w.x / eta, w.y / eta, cos_refracted};
}

struct Scattering {
  Rgb value;
  float pdf;
};
/// Both continuous parts at once, for directions above the surface and a rough metal.
inline Scattering Scatter(const CoatedConductorBsdf& bsdf, const CoatDirection& o,
                          float border_probability, Vec3f wo, Vec3f wi) {
  const float coat_eta = bsdf.coat.interface->eta();
  const CoatDirection i = EnterCoat(bsdf.coat, wi.z);
  const Vec3f inner_o = Refracted(wo, coat_eta, o.cos_refracted);
  const Vec3f inner_i = Refracted(wi, coat_eta, i.cos_refracted);
  const Vec3f m = Normalize(inner_o + inner_i);
  const float d = bsdf.metal.D(m);
  const float inverse_eta2 = 1 / (coat_eta * coat_eta);
  Scattering result;
  result.value = bsdf.Series(AbsDot(inner_o, m), 1 / o.cos_refracted + 1 / i.cos_refracted,
                             std::min(o.reflectance, i.reflectance)) *
                 ((1 - o.reflectance) * (1 - i.reflectance) * inverse_eta2 * d *
                  bsdf.metal.VisibilityOver4(inner_o, inner_i) * wi.z);
  // Solid angles inside and outside: eta^2 cos' d omega' = cos d omega.
  result.pdf = (1 - border_probability) * 0.5f * d / (inner_o.z + bsdf.metal.Stretch(inner_o)) *
               inverse_eta2 * wi.z / inner_i.z;
  if (!bsdf.coat.IsSmooth()) {
    result.value += Rgb::Gray(EvalCoatBorder(bsdf.coat, wo, wi));
    result.pdf += border_probability * CoatBorderPdf(bsdf.coat, wo, wi);
  }
  return result;
}

inline Scattering ScatterEitherSide(const CoatedConductorBsdf& bsdf, Vec3f wo, Vec3f wi,
                                    bool with_pdf) {
  if (!(wo.z * wi.z > 0) || IsDelta(bsdf)) return {};
  wo.z = std::fabs(wo.z);
  wi.z = std::fabs(wi.z);
  const CoatDirection o = EnterCoat(bsdf.coat, wo.z);
  return Scatter(bsdf, o, with_pdf ? bsdf.BorderProbability(o) : 0, wo, wi);
}

}  // namespace coated_conductor_detail

inline Rgb Eval(const CoatedConductorBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return coated_conductor_detail::ScatterEitherSide(bsdf, wo, wi, false).value;
}

inline float Pdf(const CoatedConductorBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return coated_conductor_detail::ScatterEitherSide(bsdf, wo, wi, true).pdf;
}

inline std::optional<BsdfSample> Sample(const CoatedConductorBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f u) {
  if (wo.z == 0) return std::nullopt;
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const CoatDirection o = EnterCoat(bsdf.coat, upper.z);
  const Vec3f mirrored = {-wo.x, -wo.y, wo.z};
  if (IsDelta(bsdf)) {
    return BsdfSample{.wi = mirrored,
                      .weight = Rgb::Gray(o.reflectance) + bsdf.MetalAlbedo(o),
                      .pdf = 1,
                      .delta = true};
  }
  const float border = bsdf.BorderProbability(o);
  Vec3f wi;
  if (u_lobe < border) {
    if (bsdf.coat.IsSmooth()) {
      return BsdfSample{.wi = mirrored,
                        .weight = Rgb::Gray(o.reflectance / border),
                        .pdf = border,
                        .delta = true};
    }
    wi = Reflect(upper, bsdf.coat.ggx.SampleVisibleNormal(upper, u));
  } else {
    const float coat_eta = bsdf.coat.interface->eta();
    const Vec3f inner_o = coated_conductor_detail::Refracted(upper, coat_eta, o.cos_refracted);
    const Vec3f inner_i = Reflect(inner_o, bsdf.metal.SampleVisibleNormal(inner_o, u));
    const float sin2 = coat_eta * coat_eta * (inner_i.x * inner_i.x + inner_i.y * inner_i.y);
    // Totally reflected light is part of the series, not of this sample.
    if (!(inner_i.z > 0) || !(sin2 < 1)) return std::nullopt;
    wi = {coat_eta * inner_i.x, coat_eta * inner_i.y, std::sqrt(1 - sin2)};
  }
  if (!(wi.z > 0)) return std::nullopt;
  const auto [value, pdf] = coated_conductor_detail::Scatter(bsdf, o, border, upper, wi);
  if (!(pdf > 0)) return std::nullopt;
  wi.z = std::copysign(wi.z, wo.z);
  return BsdfSample{.wi = wi, .weight = value / pdf, .pdf = pdf};
}

inline Rgb Albedo(const CoatedConductorBsdf& bsdf, Vec3f wo) {
  const CoatDirection o = EnterCoat(bsdf.coat, std::fabs(wo.z));
  return Rgb::Gray(o.reflectance) + bsdf.MetalAlbedo(o);
}

}  // namespace strata
