#pragma once

#include <algorithm>
#include <cmath>

#include "worker/bsdf/albedo_table.h"
#include "worker/bsdf/fresnel.h"
#include "worker/bsdf/ggx.h"
#include "worker/math/elementary.h"

namespace strata {

/// What the upper border of a coat of one index does on the whole, computed once at load.
/// Reflectances are those of light from outside.
class CoatInterface {
 public:
  explicit CoatInterface(float eta);

  float eta() const { return eta_; }
  /// Directional albedo of the GGX reflection of the border, alpha = 1e-3..1.
  float RoughReflectance(float cos_theta, float alpha) const {
    return reflectance_.At(cos_theta, alpha);
  }
  AlbedoTable::Row RoughReflectances(float alpha) const { return reflectance_.RowAt(alpha); }
  /// Cosine-weighted mean of the reflectance over the hemisphere; alpha 0 is the smooth border.
  float MeanReflectance(float alpha) const {
    return alpha == 0 ? smooth_mean_ : reflectance_.Mean(alpha);
  }
  /// Mean path through the layer, in units of its thickness, of diffuse light from below that the
  /// border sends back.
  float internal_path() const { return internal_path_; }
  /// The same of that which the border lets out.
  float escaping_path() const { return escaping_path_; }

 private:
  float eta_;
  float smooth_mean_;
  float internal_path_, escaping_path_;
  AlbedoTable reflectance_;
};

/// A dielectric layer over a base (PBRT 14.3, there by random walks): its border above (smooth or
/// GGX) and what it absorbs.
struct Coat {
  const CoatInterface* interface = nullptr;  ///< Outlives the BSDF.
  Ggx ggx;
  Rgb optical_depth;  ///< Of absorption, across the layer at normal incidence.

  bool IsSmooth() const { return ggx.IsSmooth(); }
  float Alpha() const { return IsSmooth() ? 0 : std::sqrt(ggx.alpha_x * ggx.alpha_y); }
};

/// One direction as the coat sees it.
struct CoatDirection {
  float reflectance;    ///< Of the border as a whole; the rest enters.
  float cos_refracted;  ///< > 0.
};

/// `cos_theta` in [0, 1].
inline CoatDirection EnterCoat(const Coat& coat, float cos_theta) {
  const DielectricFresnel fresnel = FresnelDielectric(cos_theta, coat.interface->eta());
  if (coat.IsSmooth()) return {fresnel.reflectance, fresnel.cos_refracted};
  return {coat.interface->RoughReflectance(cos_theta, coat.Alpha()), fresnel.cos_refracted};
}

/// What a layer of this optical depth lets through along a path of `length` times its thickness
/// (PBRT 11.2).
inline Rgb CoatTransmittance(Rgb depth, float length) {
  if (IsBlack(depth)) return Rgb::Gray(1);
  if (depth.r == depth.g && depth.g == depth.b) return Rgb::Gray(Exp(-depth.r * length));
  const auto through = [length](float d) { return d == 0 ? 1 : Exp(-d * length); };
  return {through(depth.r), through(depth.g), through(depth.b)};
}

/// Of the light that enters a smooth coat from a cosine, over a metal of roughness alpha that
/// reflects all, the part that CoatedConductorBsdf's lobe does not bring out again: the metal sends
/// it beyond the critical angle, or its microfacets hide it.
AlbedoTable TabulateTrappedLight(float eta);

/// Reflection off a rough border, as a microfacet BRDF times |cos|; both directions above.
inline float EvalCoatBorder(const Coat& coat, Vec3f wo, Vec3f wi) {
  const Vec3f m = Normalize(wo + wi);
  const float fresnel =
      FresnelDielectric(Min(AbsDot(wo, m), 1.0f), coat.interface->eta()).reflectance;
  return fresnel * coat.ggx.D(m) * coat.ggx.VisibilityOver4(wo, wi) * wi.z;
}
inline float CoatBorderPdf(const Coat& coat, Vec3f wo, Vec3f wi) {
  return 0.25f * coat.ggx.VisibleNormalPdfOverCos(wo, Normalize(wo + wi));
}

}  // namespace strata
