#pragma once

#include <algorithm>
#include <cmath>

#include "worker/bsdf/fresnel.h"
#include "worker/bsdf/ggx.h"

namespace strata {

/// The mean of f(cosine of wo to m, wi) G2 / G1 over the normals m visible from the cosine in a GGX
/// surface (PBRT 9.6.4), wi = wo mirrored about m, by a midpoint rule over the unit square, where
/// the integrands are smooth: with f = Fresnel's reflectance it is the directional albedo of the
/// surface.
template <typename Function>
float MeanOverVisibleNormals(float cos_theta, float alpha, int steps, const Function& f) {
  const Ggx ggx = {alpha, alpha};
  const Vec3f wo = {std::sqrt(std::max(0.0f, 1 - cos_theta * cos_theta)), 0, cos_theta};
  double sum = 0;
  for (int i = 0; i < steps; ++i) {
    for (int j = 0; j < steps; ++j) {
      // Half a turn suffices by symmetry.
      const Vec2f u = {0.5f * (static_cast<float>(i) + 0.5f) / static_cast<float>(steps),
                       (static_cast<float>(j) + 0.5f) / static_cast<float>(steps)};
      const Vec3f m = ggx.SampleVisibleNormal(wo, u);
      const Vec3f wi = Reflect(wo, m);
      if (wi.z > 0) sum += ggx.MaskingRatio(wo, wi) * f(std::clamp(Dot(wo, m), 0.0f, 1.0f), wi);
    }
  }
  return static_cast<float>(sum / (steps * steps));
}

}  // namespace strata
