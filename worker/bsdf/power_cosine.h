#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"

namespace strata {

/// Microfacet normals whose density falls off with a power of the cosine, another one along each
/// axis: cos^n theta with n = nu cos^2 phi + nv sin^2 phi (Ashikhmin and Shirley 2000, JGT 5(2);
/// equal exponents are Blinn's, PBRT 2nd ed. 8.4.2). Normals are local, unit, with m.z >= 0.
struct PowerCosine {
  float nu = 0, nv = 0;  ///< 0 or more.

  /// cos^n theta, near the axis from the sine, so that large exponents magnify no rounding.
  float Power(Vec3f m) const {
    const float x2 = m.x * m.x, y2 = m.y * m.y, sin2 = x2 + y2;
    const float weighted = nu * x2 + nv * y2;
    if (!(weighted > 0)) return 1;
    const float log_cos2 = sin2 < 0.5f ? Log1p(-sin2) : Log(m.z * m.z);
    return Exp(0.5f * (weighted / sin2) * log_cos2);
  }

  /// Of Sample, per solid angle of m.
  float Pdf(Vec3f m) const { return std::sqrt((nu + 1) * (nv + 1)) * (0.5f * kInvPi) * Power(m); }

  /// The azimuth by Ashikhmin and Shirley's equation 9, written without the tangent; then the sine
  /// of the polar angle by inversion.
  Vec3f Sample(Vec2f u) const {
    const SinCosResult<float> turn = SinCos2Pi(u.x);
    const float x = std::sqrt(nv + 1) * turn.cos, y = std::sqrt(nu + 1) * turn.sin;
    const float length2 = x * x + y * y;
    const float n = (nu * x * x + nv * y * y) / length2;
    // cos theta = (1 - u)^(1 / (n + 1)).
    const float sin2 = std::clamp(-Expm1(2 / (n + 1) * Log1p(-u.y)), 0.0f, 1.0f);
    const float scale = std::sqrt(sin2 / length2);
    return {x * scale, y * scale, std::sqrt(1 - sin2)};
  }
};

}  // namespace strata
