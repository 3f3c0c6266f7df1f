#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"

// Densities whose distribution function inverts in closed form (PBRT 2.3, A.4). Each SampleX takes
// u in [0, 1) to a point of density XPdf, monotonically, so that stratified numbers stay
// stratified; InvertX takes the point back to u.

namespace strata {

/// p(x) = (n + 1) x^n on [0, 1], n > -1.
inline float SamplePower(float u, float n) { return Pow(u, 1 / (n + 1)); }
inline float PowerPdf(float x, float n) { return x >= 0 && x <= 1 ? (n + 1) * Pow(x, n) : 0; }
inline float InvertPower(float x, float n) { return Pow(x, n + 1); }

/// p(x) = a e^(-a x) for x >= 0, a > 0 (PBRT A.4.2).
inline float SampleExponential(float u, float a) { return -Log(1 - u) / a; }
inline float ExponentialPdf(float x, float a) { return x >= 0 ? a * Exp(-a * x) : 0; }
/// Within 1e-7, absolute.
inline float InvertExponential(float x, float a) { return 1 - Exp(-a * x); }

/// p(x) in proportion to a line from a at 0 to b at 1; a, b >= 0, not both 0 (PBRT 2.3.2). The
/// quadratic is solved in the form that does not cancel.
inline float SampleLinear(float u, float a, float b) {
  const float denominator = a + std::sqrt((1 - u) * a * a + u * b * b);
  return denominator > 0 ? std::min(u * (a + b) / denominator, 1.0f) : 0;
}
inline float LinearPdf(float x, float a, float b) {
  return x >= 0 && x <= 1 ? 2 * ((1 - x) * a + x * b) / (a + b) : 0;
}
inline float InvertLinear(float x, float a, float b) { return x * (2 * a + x * (b - a)) / (a + b); }

/// p(x, y) in proportion to what bilinear interpolation makes of `corners` at (0, 0), (1, 0),
/// (0, 1), (1, 1); none negative, not all 0. First y by its marginal density, then x by its
/// conditional one (PBRT 2.4.2); both are linear.
inline Vec2f SampleBilinear(Vec2f u, const std::array<float, 4>& corners) {
  const float y = SampleLinear(u.y, corners[0] + corners[1], corners[2] + corners[3]);
  return {SampleLinear(u.x, (1 - y) * corners[0] + y * corners[2],
                       (1 - y) * corners[1] + y * corners[3]),
          y};
}
inline float BilinearPdf(Vec2f p, const std::array<float, 4>& corners) {
  if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1)) return 0;
  const float low = (1 - p.x) * corners[0] + p.x * corners[1];
  const float high = (1 - p.x) * corners[2] + p.x * corners[3];
  return 4 * ((1 - p.y) * low + p.y * high) / (corners[0] + corners[1] + corners[2] + corners[3]);
}
inline Vec2f InvertBilinear(Vec2f p, const std::array<float, 4>& corners) {
  return {InvertLinear(p.x, (1 - p.y) * corners[0] + p.y * corners[2],
                       (1 - p.y) * corners[1] + p.y * corners[3]),
          InvertLinear(p.y, corners[0] + corners[1], corners[2] + corners[3])};
}

}  // namespace strata
