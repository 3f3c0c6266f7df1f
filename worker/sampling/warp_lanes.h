#pragma once

#include <initializer_list>

#include "worker/math/elementary.h"
#include "worker/math/lanes.h"

// What warp.h and elementary.h do for one value, for eight.

namespace strata {

inline SinCosResult<FloatLanes> SinCos2Pi(FloatLanes u) {
  const auto horner = [](FloatLanes x, std::initializer_list<float> falling) {
    FloatLanes sum = SameFloat(*falling.begin());
    for (const float* c = falling.begin() + 1; c != falling.end(); ++c) sum = sum * x + *c;
    return sum;
  };
  const FloatLanes quadrant = Floor(4 * u + 0.5f);
  const FloatLanes r = u - 0.25f * quadrant;
  const FloatLanes r2 = r * r;
  const FloatLanes sin =
      r * horner(r2, {122.551964f, -79.56571198f, 81.63905334f, -41.34185028f, 6.2831855f});
  const FloatLanes cos =
      horner(r2, {58.81533051f, -85.4295044f, 64.93917847f, -19.73920822f, 1.0f});
  const IntLanes q = ToInt(quadrant);
  const MaskLanes swap = (q & 1) != 0;
  const FloatLanes s = swap ? cos : sin, c = swap ? sin : cos;
  return {(q & 2) != 0 ? -s : s, ((q + 1) & 2) != 0 ? -c : c};
}

inline Vec2Lanes SampleConcentricDisk(Vec2Lanes u) {
  const FloatLanes a = 2 * u.x - 1, b = 2 * u.y - 1;
  const MaskLanes a_larger = Abs(a) > Abs(b);
  const FloatLanes radius = a_larger ? a : b;
  const FloatLanes other = a_larger ? b : a;
  const FloatLanes eighths = radius != 0 ? other / radius : FloatLanes{};
  const SinCosResult<FloatLanes> angle = SinCos2Pi(0.125f * eighths);
  return {radius * (a_larger ? angle.cos : angle.sin), radius * (a_larger ? angle.sin : angle.cos)};
}

inline Vec3Lanes SampleCosineHemisphere(Vec2Lanes u) {
  const Vec2Lanes d = SampleConcentricDisk(u);
  return {d.x, d.y, Sqrt(Max(FloatLanes{}, 1 - d.x * d.x - d.y * d.y))};
}

/// Weights of the first two corners of a triangle.
inline Vec2Lanes SampleTriangle(Vec2Lanes u) {
  const FloatLanes low = 0.5f * u.y, high = 0.5f * u.x;
  return {u.x > u.y ? u.x - low : high, u.x > u.y ? low : u.y - high};
}

/// The power heuristic for eight samples.
inline FloatLanes PowerHeuristic(FloatLanes pdf, FloatLanes other_pdf) {
  const FloatLanes ratio = other_pdf / pdf;
  const FloatLanes weight = ratio == ratio ? 1 / (1 + ratio * ratio) : SameFloat(0.5f);
  return pdf > 0 ? weight : FloatLanes{};
}

}  // namespace strata
