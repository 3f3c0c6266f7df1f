#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/coat.h"
#include "worker/sampling/warp.h"

namespace strata {

/// A dielectric coat over a metal, the same on both sides, in closed form: light is refracted into
/// the coat, reflected by the metal there, and refracted out; what the border sends back down
/// towards the same direction is summed as a geometric series, and what the metal spreads beyond
/// the critical angle comes out evenly,
///
///   f = border + (1 - E(wo)) (1 - E(wi)) f_metal(wo', wi') / (eta^2 (1 - min(E(wo), E(wi)) F))
///     + M(wo) M(wi) C / (pi mean M)
///
/// with E the border's albedo, F the metal's Fresnel reflectance, ' the refracted directions, M the
/// light the second term leaves in the coat and C the part of it that the metal does not absorb
/// (docs/materials.md). Exact when both are smooth; a metal that reflects all loses nothing.
struct CoatedConductorBsdf {
  Coat coat;
  Rgb eta, k;  ///< Of the metal relative to the coat.
  Ggx metal;   ///< With the spread that a rough border adds to what passes it twice.
  const AlbedoTable* trapped = nullptr;  ///< Outlives the BSDF.
  float mean_trapped = 0;                ///< Mean M.
  Rgb spread;                            ///< C / (pi mean M).

  CoatedConductorBsdf() = default;
  /// `trapped_light` is TabulateTrappedLight for the coat's index.
  CoatedConductorBsdf(const Coat& c, const AlbedoTable* trapped_light, Rgb metal_eta, Rgb metal_k,
                      Ggx ggx)
      : coat(c), eta(metal_eta), k(metal_k), metal(ggx), trapped(trapped_light) {
    if (!coat.IsSmooth()) WidenMetal();
    if (metal.IsSmooth()) return;
    // After its first return, trapped light is diffuse: it meets the metal again and leaves with
    // the probability of diffuse light, or stays for another turn.
    const float coat_eta = coat.interface->eta();
    const float leaving =
        (1 - coat.interface->MeanReflectance(coat.Alpha())) / (coat_eta * coat_eta);
    const Rgb fresnel = FresnelConductor(kMeanCosine, eta, k);
    const Rgb turn =
        fresnel * CoatTransmittance(coat.optical_depth, 2 * coat.interface->internal_path());
    const Rgb returned = fresnel * turn * leaving / (Rgb::Gray(1) - turn * (1 - leaving));
    mean_trapped = MeanTrapped();
    spread = returned * (kInvPi / std::max(mean_trapped, 1e-6f));
  }

  float MetalAlpha() const { return std::sqrt(metal.alpha_x * metal.alpha_y); }
  /// M of the formula.
  float Trapped(const CoatDirection& direction, float cos_theta) const {
    return (1 - direction.reflectance) * trapped->At(cos_theta, MetalAlpha());
  }

  /// What the metal returns at the cosine of its own microfacets, internal reflections included.
  Rgb Series(float cos_metal, float length, float returned) const {
    const Rgb transmittance = CoatTransmittance(coat.optical_depth, length);
    const Rgb once = FresnelConductor(Min(cos_metal, 1.0f), eta, k) * transmittance;
    return once / (Rgb::Gray(1) - once * returned);
  }

  /// Where light goes, by albedo: to the border's reflection, the metal's, and the even rest.
  struct Shares {
    float border;
    Rgb metal, even;
  };
  Shares AlbedoShares(const CoatDirection& o, float cos_theta) const {
    const float entering = 1 - o.reflectance;
    const Rgb mirror = Series(o.cos_refracted, 2 / o.cos_refracted, o.reflectance);
    if (metal.IsSmooth()) return {o.reflectance, mirror * (entering * entering), {}};
    const float left = Trapped(o, cos_theta);
    const Rgb even = spread * (kPi * left * mean_trapped) *
                     CoatTransmittance(coat.optical_depth,
                                       1 / o.cos_refracted + coat.interface->escaping_path());
    // (1 - F) mirror is 1 for a metal that reflects all.
    return {o.reflectance, mirror * ((entering - left) * entering), even};
  }

 private:
  /// Of GGX's microfacets in diffuse light, roughly; for the colour of trapped light alone.
  static constexpr float kMeanCosine = 0.7f;

  /// Over the cosine-weighted hemisphere: the integral of M 4 s^3 ds, s = sqrt(cos).
  float MeanTrapped() const {
    constexpr int kSteps = 12;
    float sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const float s = (static_cast<float>(i) + 0.5f) / kSteps;
      sum += Trapped(EnterCoat(coat, s * s), s * s) * s * s * s;
    }
    return sum * (4.0f / kSteps);
  }

  /// A border tilted by h turns what passes it by (1 - 1/eta) h, as a metal tilted by half of that
  /// would; the two passages are independent. The metal is never smooth under a rough border.
  void WidenMetal() {
    const float turn = 1 - 1 / coat.interface->eta();
    const auto widen = [&](float alpha, float border) {
      return std::max(std::sqrt(alpha * alpha + 0.5f * turn * turn * border * border), 1e-3f);
    };
    metal = {widen(metal.alpha_x, coat.ggx.alpha_x), widen(metal.alpha_y, coat.ggx.alpha_y)};
  }
};

inline bool IsDelta(const CoatedConductorBsdf& bsdf) { return bsdf.metal.IsSmooth(); }
inline bool HasDelta(const CoatedConductorBsdf& bsdf) {
  return bsdf.coat.IsSmooth() || IsDelta(bsdf);
}

namespace coated_conductor_detail {

/// Probabilities of the three parts.
struct Lobes {
  float border = 0, metal = 0, even = 0;
};
inline Lobes ChooseLobes(const CoatedConductorBsdf& bsdf, const CoatDirection& o, float cos_theta) {
  const CoatedConductorBsdf::Shares shares = bsdf.AlbedoShares(o, cos_theta);
  const float metal = MaxComponent(shares.metal), even = MaxComponent(shares.even);
  const float scale = 1 / (shares.border + metal + even);
  return {shares.border * scale, metal * scale, even * scale};
}

/// An upper direction as it goes on inside the coat, still pointing away from the metal.
inline Vec3f Refracted(Vec3f w, float eta, float cos_refracted) {
  return {w.x / eta, w.y / eta, cos_refracted};
}

/// All continuous parts at once, for directions above the surface and a rough metal.
inline BsdfValue Scatter(const CoatedConductorBsdf& bsdf, const CoatDirection& o,
                         const Lobes& lobes, Vec3f wo, Vec3f wi) {
  const float coat_eta = bsdf.coat.interface->eta();
  const CoatDirection i = EnterCoat(bsdf.coat, wi.z);
  const Vec3f inner_o = Refracted(wo, coat_eta, o.cos_refracted);
  const Vec3f inner_i = Refracted(wi, coat_eta, i.cos_refracted);
  const Vec3f m = Normalize(inner_o + inner_i);
  const float d = bsdf.metal.D(m);
  const float inverse_eta2 = 1 / (coat_eta * coat_eta);
  const float length = 1 / o.cos_refracted + 1 / i.cos_refracted;
  BsdfValue result;
  result.f = bsdf.Series(AbsDot(inner_o, m), length, std::min(o.reflectance, i.reflectance)) *
             ((1 - o.reflectance) * (1 - i.reflectance) * inverse_eta2 * d *
              bsdf.metal.VisibilityOver4(inner_o, inner_i) * wi.z);
  result.f += bsdf.spread * CoatTransmittance(bsdf.coat.optical_depth, length) *
              (bsdf.Trapped(o, wo.z) * bsdf.Trapped(i, wi.z) * wi.z);
  // Solid angles inside and outside: eta^2 cos' d omega' = cos d omega.
  result.pdf = lobes.metal * 0.5f * d / (inner_o.z + bsdf.metal.Stretch(inner_o)) * inverse_eta2 *
               wi.z / inner_i.z;
  result.pdf += lobes.even * CosineHemispherePdf(wi.z);
  if (!bsdf.coat.IsSmooth()) {
    result.f += Rgb::Gray(EvalCoatBorder(bsdf.coat, wo, wi));
    result.pdf += lobes.border * CoatBorderPdf(bsdf.coat, wo, wi);
  }
  return result;
}

inline BsdfValue ScatterEitherSide(const CoatedConductorBsdf& bsdf, Vec3f wo, Vec3f wi,
                                   bool with_pdf) {
  if (!(wo.z * wi.z > 0) || IsDelta(bsdf)) return {};
  wo.z = std::fabs(wo.z);
  wi.z = std::fabs(wi.z);
  const CoatDirection o = EnterCoat(bsdf.coat, wo.z);
  return Scatter(bsdf, o, with_pdf ? ChooseLobes(bsdf, o, wo.z) : Lobes{}, wo, wi);
}

/// A direction off the metal, or none if it is hidden or beyond the critical angle.
inline std::optional<Vec3f> SampleMetal(const CoatedConductorBsdf& bsdf, const CoatDirection& o,
                                        Vec3f wo, Vec2f u) {
  const float coat_eta = bsdf.coat.interface->eta();
  const Vec3f inner_o = Refracted(wo, coat_eta, o.cos_refracted);
  const Vec3f inner_i = Reflect(inner_o, bsdf.metal.SampleVisibleNormal(inner_o, u));
  const float sin2 = coat_eta * coat_eta * (inner_i.x * inner_i.x + inner_i.y * inner_i.y);
  if (!(inner_i.z > 0) || !(sin2 < 1)) return std::nullopt;
  return Vec3f{coat_eta * inner_i.x, coat_eta * inner_i.y, std::sqrt(1 - sin2)};
}

}  // namespace coated_conductor_detail

inline Rgb Eval(const CoatedConductorBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return coated_conductor_detail::ScatterEitherSide(bsdf, wo, wi, false).f;
}

inline float Pdf(const CoatedConductorBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return coated_conductor_detail::ScatterEitherSide(bsdf, wo, wi, true).pdf;
}

inline BsdfValue EvalPdf(const CoatedConductorBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return coated_conductor_detail::ScatterEitherSide(bsdf, wo, wi, true);
}

inline Rgb Albedo(const CoatedConductorBsdf& bsdf, Vec3f wo) {
  const float cos_theta = std::fabs(wo.z);
  const CoatDirection o = EnterCoat(bsdf.coat, cos_theta);
  const CoatedConductorBsdf::Shares shares = bsdf.AlbedoShares(o, cos_theta);
  return Rgb::Gray(shares.border) + shares.metal + shares.even;
}

inline std::optional<BsdfSample> Sample(const CoatedConductorBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f u) {
  if (wo.z == 0) return std::nullopt;
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const Vec3f mirrored = {-wo.x, -wo.y, wo.z};
  if (IsDelta(bsdf)) {
    return BsdfSample{.wi = mirrored, .weight = Albedo(bsdf, wo), .pdf = 1, .delta = true};
  }
  const CoatDirection o = EnterCoat(bsdf.coat, upper.z);
  const auto lobes = coated_conductor_detail::ChooseLobes(bsdf, o, upper.z);
  Vec3f wi;
  if (u_lobe < lobes.border) {
    if (bsdf.coat.IsSmooth()) {
      return BsdfSample{.wi = mirrored,
                        .weight = Rgb::Gray(o.reflectance / lobes.border),
                        .pdf = lobes.border,
                        .delta = true};
    }
    wi = Reflect(upper, bsdf.coat.ggx.SampleVisibleNormal(upper, u));
  } else if (u_lobe < lobes.border + lobes.metal) {
    const std::optional<Vec3f> reflected = coated_conductor_detail::SampleMetal(bsdf, o, upper, u);
    if (!reflected) return std::nullopt;
    wi = *reflected;
  } else {
    wi = SampleCosineHemisphere(u);
  }
  if (!(wi.z > 0)) return std::nullopt;
  const auto [f, pdf] = coated_conductor_detail::Scatter(bsdf, o, lobes, upper, wi);
  if (!(pdf > 0)) return std::nullopt;
  wi.z = std::copysign(wi.z, wo.z);
  return BsdfSample{.wi = wi, .weight = f / pdf, .pdf = pdf};
}

}  // namespace strata
