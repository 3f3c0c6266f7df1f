#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "worker/bsdf/albedo_table.h"
#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/fresnel.h"
#include "worker/bsdf/ggx.h"
#include "worker/sampling/warp.h"

namespace strata {

/// Directional albedos of GGX microfacets whose reflectance is Schlick's F = f0 + (f90 - f0) s,
/// s = (1 - cos)^5: linear in f0 and f90, so that two tables serve all colours.
class SchlickAlbedo {
 public:
  SchlickAlbedo();

  /// The albedo is f0 `normal` + f90 `grazing`.
  struct Split {
    float normal = 0, grazing = 0;
    float Of(float f0, float f90) const { return f0 * normal + f90 * grazing; }
    Rgb Of(Rgb f0, float f90) const { return f0 * normal + Rgb::Gray(f90 * grazing); }
  };
  /// `cos_theta` in [0, 1]; exact for a smooth surface.
  Split At(const Ggx& ggx, float cos_theta) const;
  /// Cosine-weighted mean over the hemisphere.
  Split Mean(const Ggx& ggx) const;

 private:
  AlbedoTable normal_, grazing_;
};

/// What a metallic-roughness surface is at one point; all but specular_color in [0, 1].
struct MetallicRoughness {
  Rgb base_color;
  float metallic = 0;
  float alpha = 1;                 ///< GGX's: glTF's roughness, squared.
  float f0 = 0.04f;                ///< Of the dielectric, at normal incidence.
  Rgb specular_color = {1, 1, 1};  ///< Multiplies f0, up to 1. Not negative.
  float specular = 1;              ///< Multiplies the dielectric's reflectance at all angles.
  float transmission =
      0;           ///< Share of the dielectric's light that passes instead of being diffuse.
  float coat = 0;  ///< Share of the surface under a clear coat of f0 = 0.04.
  float coat_alpha = 0;
};

/// The surface of glTF 2.0 (appendix B; KHR_materials_specular, _transmission of thin walls,
/// _clearcoat), the same on both sides: a metal and a dielectric of the same GGX microfacets, mixed
/// by `metallic`; the dielectric is a Fresnel-weighted mix of reflection with diffuse light or with
/// light that passes straight on; over them a clear coat:
///
///   f = K(wo) K(wi) [ F D V + T (1 - Fd) D V* + rho (1 - E(wo)) (1 - E(wi)) / (pi (1 - mean E)) ]
///     + coat Fc Dc Vc,   K = 1 - coat Ec
///
/// with E, Ec the directional albedos of the dielectric's and the coat's reflection and * the
/// mirror image of wi below the surface. The appendix weights diffuse light by 1 - F(wo . m), which
/// returns up to 1.9 times the light that comes in at grazing angles; with albedos instead a white
/// dielectric returns all of it at any angle, and the value stays reciprocal. GGX lobes scatter
/// once.
struct MetallicRoughnessBsdf {
  const SchlickAlbedo* albedo = nullptr;  ///< Outlives the BSDF.
  Ggx ggx, coat_ggx;
  Rgb f0;                                       ///< Of metal and dielectric together.
  float f90 = 1;                                ///< Likewise.
  float dielectric_f0 = 0, dielectric_f90 = 0;  ///< Of the strongest channel.
  Rgb diffuse;                                  ///< rho / (1 - mean E).
  Rgb transmission;                             ///< T.
  float coat = 0;

  static constexpr float kCoatF0 = 0.04f;

  MetallicRoughnessBsdf() = default;
  MetallicRoughnessBsdf(const SchlickAlbedo* tables, const MetallicRoughness& m)
      : albedo(tables),
        ggx(Ggx::FromAlpha(m.alpha, m.alpha)),
        coat_ggx(Ggx::FromAlpha(m.coat_alpha, m.coat_alpha)),
        coat(m.coat) {
    const float dielectric = 1 - m.metallic;
    const Rgb color = m.specular_color * m.f0;
    const Rgb dielectric_color =
        Rgb{std::min(color.r, 1.0f), std::min(color.g, 1.0f), std::min(color.b, 1.0f)} * m.specular;
    f0 = m.base_color * m.metallic + dielectric_color * dielectric;
    f90 = m.metallic + m.specular * dielectric;
    dielectric_f0 = MaxComponent(dielectric_color);
    dielectric_f90 = m.specular;
    transmission = m.base_color * (dielectric * m.transmission);
    diffuse = m.base_color * (dielectric * (1 - m.transmission));
    if (IsBlack(diffuse)) return;
    diffuse *= 1 / (1 - albedo->Mean(ggx).Of(dielectric_f0, dielectric_f90));
  }

  /// Schlick's (1 - cos)^5.
  static float Grazing(float cosine) {
    const float x = std::max(0.0f, 1 - cosine), x2 = x * x;
    return x2 * x2 * x;
  }
  static float Fresnel(float f0, float f90, float grazing) { return f0 + (f90 - f0) * grazing; }
  static Rgb Fresnel(Rgb f0, float f90, float grazing) {
    return f0 + (Rgb::Gray(f90) - f0) * grazing;
  }
};

inline bool IsDelta(const MetallicRoughnessBsdf& bsdf) {
  return bsdf.ggx.IsSmooth() && IsBlack(bsdf.diffuse) &&
         (bsdf.coat == 0 || bsdf.coat_ggx.IsSmooth());
}

namespace metallic_roughness_detail {

/// One direction as the surface sees it.
struct Facing {
  SchlickAlbedo::Split split;
  float entering = 1;  ///< 1 - E.
  float through = 1;   ///< K.
};
inline Facing Face(const MetallicRoughnessBsdf& bsdf, float cos_theta) {
  Facing facing;
  facing.split = bsdf.albedo->At(bsdf.ggx, cos_theta);
  facing.entering = 1 - facing.split.Of(bsdf.dielectric_f0, bsdf.dielectric_f90);
  if (bsdf.coat > 0) {
    facing.through = 1 - bsdf.coat * bsdf.albedo->At(bsdf.coat_ggx, cos_theta).Of(bsdf.kCoatF0, 1);
  }
  return facing;
}

/// Probabilities of the lobes, by albedo.
struct Lobes {
  float coat = 0, reflection = 0, transmission = 0, diffuse = 0;
};
inline Lobes ChooseLobes(const MetallicRoughnessBsdf& bsdf, const Facing& o) {
  Lobes lobes;
  lobes.coat = 1 - o.through;
  lobes.reflection = o.through * MaxComponent(o.split.Of(bsdf.f0, bsdf.f90));
  lobes.transmission = o.through * MaxComponent(bsdf.transmission) *
                       o.split.Of(1 - bsdf.dielectric_f0, 1 - bsdf.dielectric_f90);
  lobes.diffuse = o.through * MaxComponent(bsdf.diffuse) * o.entering;
  const float sum = lobes.coat + lobes.reflection + lobes.transmission + lobes.diffuse;
  if (!(sum > 0)) return {};
  const float scale = 1 / sum;
  return {lobes.coat * scale, lobes.reflection * scale, lobes.transmission * scale,
          lobes.diffuse * scale};
}

/// All continuous parts at once. wo.z > 0; `wi` is above the surface, or the mirror image of a
/// direction below it if `passes`.
inline BsdfValue Scatter(const MetallicRoughnessBsdf& bsdf, const Facing& o, const Lobes& lobes,
                         Vec3f wo, Vec3f wi, bool passes) {
  BsdfValue value;
  if (passes && (IsBlack(bsdf.transmission) || bsdf.ggx.IsSmooth())) return value;
  const Facing i = Face(bsdf, wi.z);
  const Vec3f m = Normalize(wo + wi);
  const float grazing = bsdf.Grazing(Dot(wo, m));
  if (!bsdf.ggx.IsSmooth()) {
    const float lobe = bsdf.ggx.D(m) * bsdf.ggx.VisibilityOver4(wo, wi) * wi.z;
    const float pdf = 0.25f * bsdf.ggx.VisibleNormalPdfOverCos(wo, m);
    if (passes) {
      const float entering = 1 - bsdf.Fresnel(bsdf.dielectric_f0, bsdf.dielectric_f90, grazing);
      value.f = bsdf.transmission * (entering * lobe);
      value.pdf = lobes.transmission * pdf;
    } else {
      value.f = bsdf.Fresnel(bsdf.f0, bsdf.f90, grazing) * lobe;
      value.pdf = lobes.reflection * pdf;
    }
  }
  if (!passes) {
    value.f += bsdf.diffuse * (o.entering * i.entering * kInvPi * wi.z);
    value.pdf += lobes.diffuse * CosineHemispherePdf(wi.z);
  }
  if (bsdf.coat == 0) return value;
  value.f *= o.through * i.through;
  if (!passes && !bsdf.coat_ggx.IsSmooth()) {
    value.f += Rgb::Gray(bsdf.coat * bsdf.Fresnel(bsdf.kCoatF0, 1, grazing) * bsdf.coat_ggx.D(m) *
                         bsdf.coat_ggx.VisibilityOver4(wo, wi) * wi.z);
    value.pdf += lobes.coat * 0.25f * bsdf.coat_ggx.VisibleNormalPdfOverCos(wo, m);
  }
  return value;
}

}  // namespace metallic_roughness_detail

inline BsdfValue EvalPdf(const MetallicRoughnessBsdf& bsdf, Vec3f wo, Vec3f wi) {
  using namespace metallic_roughness_detail;
  if (wo.z == 0 || wi.z == 0) return {};
  const bool passes = wo.z * wi.z < 0;
  wo.z = std::fabs(wo.z);
  wi.z = std::fabs(wi.z);
  const Facing o = Face(bsdf, wo.z);
  return Scatter(bsdf, o, ChooseLobes(bsdf, o), wo, wi, passes);
}
inline Rgb Eval(const MetallicRoughnessBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return EvalPdf(bsdf, wo, wi).f;
}
inline float Pdf(const MetallicRoughnessBsdf& bsdf, Vec3f wo, Vec3f wi) {
  return EvalPdf(bsdf, wo, wi).pdf;
}

inline std::optional<BsdfSample> Sample(const MetallicRoughnessBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f u) {
  using namespace metallic_roughness_detail;
  if (wo.z == 0) return std::nullopt;
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const Facing o = Face(bsdf, upper.z);
  const Lobes lobes = ChooseLobes(bsdf, o);
  const float grazing = bsdf.Grazing(upper.z);
  const auto mirror = [&](Rgb reflected, float probability) {
    return BsdfSample{.wi = {-wo.x, -wo.y, wo.z},
                      .weight = reflected / probability,
                      .pdf = probability,
                      .delta = true};
  };
  const auto reflect = [&](const Ggx& ggx) {
    return Reflect(upper, ggx.SampleVisibleNormal(upper, u));
  };
  Vec3f wi;
  bool passes = false;
  if (u_lobe < lobes.coat) {
    if (bsdf.coat_ggx.IsSmooth()) return mirror(Rgb::Gray(1 - o.through), lobes.coat);
    wi = reflect(bsdf.coat_ggx);
  } else if (u_lobe < lobes.coat + lobes.reflection) {
    if (bsdf.ggx.IsSmooth()) {
      return mirror(bsdf.Fresnel(bsdf.f0, bsdf.f90, grazing) * (o.through * o.through),
                    lobes.reflection);
    }
    wi = reflect(bsdf.ggx);
  } else if (u_lobe < lobes.coat + lobes.reflection + lobes.transmission) {
    passes = true;
    if (bsdf.ggx.IsSmooth()) {
      BsdfSample sample =
          mirror(bsdf.transmission * (o.entering * o.through * o.through), lobes.transmission);
      sample.wi = -wo;
      sample.transmission = true;
      return sample;
    }
    wi = reflect(bsdf.ggx);
  } else {
    if (!(lobes.diffuse > 0)) return std::nullopt;
    wi = SampleCosineHemisphere(u);
  }
  if (!(wi.z > 0)) return std::nullopt;
  const auto [f, pdf] = Scatter(bsdf, o, lobes, upper, wi, passes);
  if (!(pdf > 0)) return std::nullopt;
  wi.z = std::copysign(wi.z, passes ? -wo.z : wo.z);
  return BsdfSample{.wi = wi, .weight = f / pdf, .pdf = pdf, .transmission = passes};
}

inline Rgb Albedo(const MetallicRoughnessBsdf& bsdf, Vec3f wo) {
  using namespace metallic_roughness_detail;
  const Facing o = Face(bsdf, std::fabs(wo.z));
  const float mean_entering =
      1 - bsdf.albedo->Mean(bsdf.ggx).Of(bsdf.dielectric_f0, bsdf.dielectric_f90);
  const Rgb below = o.split.Of(bsdf.f0, bsdf.f90) + bsdf.diffuse * (o.entering * mean_entering) +
                    bsdf.transmission * o.split.Of(1 - bsdf.dielectric_f0, 1 - bsdf.dielectric_f90);
  return Rgb::Gray(1 - o.through) + below * o.through;
}

}  // namespace strata
