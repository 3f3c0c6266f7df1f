#pragma once

#include <cmath>
#include <optional>

#include "worker/bsdf/bsdf_sample.h"
#include "worker/bsdf/fresnel.h"

namespace strata {

/// A pane of clear glass so thin that light leaves it where it came in; reflections between its two
/// faces are summed (PBRT 9.5.1).
struct ThinDielectricBsdf {
  float eta = 1.5f;

  /// R + T R T + T R^3 T + ... = 2 R / (1 + R), with R that of one face.
  float Reflectance(float cos_theta) const {
    const float r = FresnelDielectric(std::fabs(cos_theta), eta).reflectance;
    return 2 * r / (1 + r);
  }
};

inline bool IsDelta(const ThinDielectricBsdf&) { return true; }
inline Rgb Eval(const ThinDielectricBsdf&, Vec3f, Vec3f) { return {}; }
inline float Pdf(const ThinDielectricBsdf&, Vec3f, Vec3f) { return 0; }

inline std::optional<BsdfSample> Sample(const ThinDielectricBsdf& bsdf, Vec3f wo, float u_lobe,
                                        Vec2f) {
  if (wo.z == 0) return std::nullopt;
  const float reflectance = bsdf.Reflectance(wo.z);
  const bool transmission = u_lobe >= reflectance;
  return BsdfSample{.wi = transmission ? -wo : Vec3f{-wo.x, -wo.y, wo.z},
                    .weight = Rgb::Gray(1),
                    .pdf = transmission ? 1 - reflectance : reflectance,
                    .delta = true,
                    .transmission = transmission};
}

inline Rgb Albedo(const ThinDielectricBsdf&, Vec3f) { return Rgb::Gray(1); }

}  // namespace strata
