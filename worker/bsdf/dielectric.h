#pragma once

#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/fresnel.h"
#include "worker/bsdf/ggx.h"

namespace strata {

/// A border between two clear media, smooth (PBRT 9.5) or with GGX microfacets (PBRT 9.7; Walter et
/// al. 2007): reflects and refracts. `eta` is the index of the side below (z < 0) over that above.
struct DielectricBsdf {
  float eta = 1.5f;
  Ggx ggx;

  /// An index of 1 bends nothing, however rough the border.
  bool IsSmooth() const { return eta == 1 || ggx.IsSmooth(); }
  /// Index behind over index before the surface, as seen along `wo`.
  float EtaFrom(Vec3f wo) const { return wo.z > 0 ? eta : 1 / eta; }
};

namespace dielectric_detail {

/// How a pair of directions meets on a microfacet.
struct Meeting {
  bool valid = false;  ///< The facet's outer side is turned to the same sides as the surface's.
  bool transmission = false;
  Vec3f m;                     ///< Unit, m.z >= 0 on the side of z > 0.
  float cos_o = 0, cos_i = 0;  ///< |wo . m|, |wi . m|.
  float reflectance = 0;
  float jacobian = 0;  ///< d omega_m / d omega_i.
};

inline Meeting Meet(const DielectricBsdf& bsdf, Vec3f wo, Vec3f wi) {
  Meeting meeting;
  if (wo.z == 0 || wi.z == 0) return meeting;
  meeting.transmission = wo.z * wi.z < 0;
  const float eta = bsdf.EtaFrom(wo);
  const Vec3f half = meeting.transmission ? wo + wi * eta : wo + wi;
  const float length2 = LengthSquared(half);
  if (!(length2 > 0) || half.z == 0) return meeting;
  meeting.m = half * (std::copysign(1.0f, half.z) / std::sqrt(length2));
  const float o_dot_m = Dot(wo, meeting.m), i_dot_m = Dot(wi, meeting.m);
  if (!(o_dot_m * wo.z > 0) || !(i_dot_m * wi.z > 0)) return meeting;
  meeting.cos_o = Min(std::fabs(o_dot_m), 1.0f);
  meeting.cos_i = Min(std::fabs(i_dot_m), 1.0f);
  meeting.reflectance = FresnelDielectric(meeting.cos_o, eta).reflectance;
  const float bend = i_dot_m * eta + o_dot_m;
  meeting.jacobian =
      meeting.transmission ? meeting.cos_i * eta * eta / (bend * bend) : 0.25f / meeting.cos_o;
  meeting.valid = true;
  return meeting;
}

}  // namespace dielectric_detail

inline bool IsDelta(const DielectricBsdf& bsdf) { return bsdf.IsSmooth(); }
inline bool HasDelta(const DielectricBsdf& bsdf) { return IsDelta(bsdf); }

inline Rgb Eval(const DielectricBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (bsdf.IsSmooth()) return {};
  const dielectric_detail::Meeting meeting = dielectric_detail::Meet(bsdf, wo, wi);
  if (!meeting.valid) return {};
  // D G2 |wo.m| jacobian / (|wo.z| |wi.z|) |wi.z|, times the share of light that goes this way.
  const float scattered = 4 * bsdf.ggx.D(meeting.m) * bsdf.ggx.VisibilityOver4(wo, wi) *
                          meeting.cos_o * meeting.jacobian * std::fabs(wi.z);
  if (!meeting.transmission) return Rgb::Gray(scattered * meeting.reflectance);
  const float eta = bsdf.EtaFrom(wo);
  return Rgb::Gray(scattered * (1 - meeting.reflectance) / (eta * eta));
}

inline float Pdf(const DielectricBsdf& bsdf, Vec3f wo, Vec3f wi) {
  if (bsdf.IsSmooth()) return 0;
  const dielectric_detail::Meeting meeting = dielectric_detail::Meet(bsdf, wo, wi);
  if (!meeting.valid) return 0;
  const float lobe = meeting.transmission ? 1 - meeting.reflectance : meeting.reflectance;
  return bsdf.ggx.VisibleNormalPdfOverCos(wo, meeting.m) * meeting.cos_o * meeting.jacobian * lobe;
}

inline std::optional<BsdfSample> Sample(const DielectricBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f u) {
  if (wo.z == 0) return std::nullopt;
  const bool smooth = bsdf.IsSmooth();
  const float eta = bsdf.EtaFrom(wo);
  const Vec3f upper = {wo.x, wo.y, std::fabs(wo.z)};
  const Vec3f m = smooth ? Vec3f{0, 0, 1} : bsdf.ggx.SampleVisibleNormal(upper, u);
  const float cos_o = Min(Dot(upper, m), 1.0f);
  if (!(cos_o > 0)) return std::nullopt;
  const DielectricFresnel fresnel = FresnelDielectric(cos_o, eta);

  BsdfSample sample;
  sample.delta = smooth;
  sample.transmission = u_lobe >= fresnel.reflectance;
  float jacobian, lobe, weight = 1;
  if (sample.transmission) {
    sample.wi = m * (cos_o / eta - fresnel.cos_refracted) - upper / eta;
    sample.eta = eta;
    weight = 1 / (eta * eta);
    lobe = 1 - fresnel.reflectance;
    const float bend = cos_o - fresnel.cos_refracted * eta;
    jacobian = fresnel.cos_refracted * eta * eta / (bend * bend);
  } else {
    sample.wi = Reflect(upper, m);
    lobe = fresnel.reflectance;
    jacobian = 0.25f / cos_o;
  }
  if (!(sample.transmission ? sample.wi.z < 0 : sample.wi.z > 0)) return std::nullopt;
  sample.pdf = lobe;
  if (!smooth) {
    weight *= bsdf.ggx.MaskingRatio(upper, sample.wi);
    sample.pdf *= bsdf.ggx.VisibleNormalPdfOverCos(upper, m) * cos_o * jacobian;
  }
  sample.weight = Rgb::Gray(weight);
  if (wo.z < 0) sample.wi.z = -sample.wi.z;
  return sample;
}

/// Of power, so without the 1/eta^2 of refracted radiance; an upper bound for a rough border.
inline Rgb Albedo(const DielectricBsdf&, Vec3f) { return Rgb::Gray(1); }

}  // namespace strata
