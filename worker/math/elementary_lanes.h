#pragma once

#include <limits>

#include "worker/math/elementary.h"
#include "worker/math/lanes.h"

// What the float functions of elementary.h do for one value, for eight: the same bits wherever
// those state a bound.

namespace strata {

namespace elementary_detail {

inline SinCosResult<FloatLanes> TurnQuadrant(FloatLanes sin, FloatLanes cos, IntLanes quadrant) {
  const MaskLanes swap = (quadrant & 1) != 0;
  const FloatLanes s = swap ? cos : sin, c = swap ? sin : cos;
  return {(quadrant & 2) != 0 ? -s : s, ((quadrant + 1) & 2) != 0 ? -c : c};
}

}  // namespace elementary_detail

inline SinCosResult<FloatLanes> SinCos2Pi(FloatLanes u) {
  using namespace elementary_detail;
  const FloatLanes quadrant = Floor(Fma(SameFloat(4), u, SameFloat(0.5f)));
  const SinCosResult<FloatLanes> reduced = SinCosWithinEighth(Fma(SameFloat(-0.25f), quadrant, u));
  return TurnQuadrant(reduced.sin, reduced.cos, ToInt(quadrant));
}

inline SinCosResult<FloatLanes> SinCos(FloatLanes x) {
  using namespace elementary_detail;
  // In double, four lanes at a time.
  __m128 reduced[2];
  __m128i quadrants[2];
  const __m256 all = x;
  for (int half = 0; half < 2; ++half) {
    const __m256d wide =
        _mm256_cvtps_pd(half == 0 ? _mm256_castps256_ps128(all) : _mm256_extractf128_ps(all, 1));
    const __m256d quadrant = _mm256_floor_pd(wide * (2 * std::numbers::inv_pi) + 0.5);
    reduced[half] = _mm256_cvtpd_ps(wide - quadrant * (std::numbers::pi / 2));
    quadrants[half] = _mm256_cvttpd_epi32(quadrant);
  }
  const FloatLanes r = _mm256_set_m128(reduced[1], reduced[0]);
  const FloatLanes r2 = r * r;
  return TurnQuadrant(r * Horner(r2, kSin), Horner(r2, kCos),
                      reinterpret_cast<IntLanes>(_mm256_set_m128i(quadrants[1], quadrants[0])));
}

inline FloatLanes Atan2(FloatLanes y, FloatLanes x) {
  using namespace elementary_detail;
  const FloatLanes ax = Abs(x), ay = Abs(y);
  const FloatLanes high = ax > ay ? ax : ay, low = ax > ay ? ay : ax;
  const MaskLanes upper = low > 0.41421356f * high;
  const FloatLanes denominator = upper ? low + high : high;
  const FloatLanes t = denominator > 0 ? (upper ? low - high : low) / denominator : denominator;
  const FloatLanes t2 = t * t;
  FloatLanes angle = Fma(t * t2, Horner(t2, kAtan), t);
  angle = upper ? angle + kPi / 4 : angle;
  angle = ((ay >= ax) & (high > 0)) ? kPi / 2 - angle : angle;
  angle = reinterpret_cast<IntLanes>(x) < 0 ? kPi - angle : angle;
  return CopySign(angle, y);
}

inline FloatLanes Exp(FloatLanes x) {
  using namespace elementary_detail;
  const FloatLanes n = Floor(x * std::numbers::log2e_v<float> + 0.5f);
  const FloatLanes r = (x - n * 0.693359375f) + n * 2.12194440e-4f;
  const IntLanes exponent = ToInt(n), half = exponent >> 1;
  const FloatLanes scale0 = reinterpret_cast<FloatLanes>((half + 127) << 23);
  const FloatLanes scale1 = reinterpret_cast<FloatLanes>((exponent - half + 127) << 23);
  const FloatLanes value = (1 + r * Horner(r, kExpSlope)) * scale0 * scale1;
  const FloatLanes below = x <= -87.33654f ? FloatLanes{} : x;  // The latter is NaN.
  const FloatLanes infinity = SameFloat(std::numeric_limits<float>::infinity());
  return !(x > -87.33654f) ? below : x > 88.72283f ? infinity : value;
}

}  // namespace strata
