#pragma once

#include "worker/math/elementary_lanes.h"

// What warp.h does for one value, for eight.

namespace strata {

inline Vec2Lanes SampleConcentricDisk(Vec2Lanes u) {
  const FloatLanes a = 2 * u.x - 1, b = 2 * u.y - 1;
  const MaskLanes a_larger = Abs(a) > Abs(b);
  const FloatLanes radius = a_larger ? a : b;
  const FloatLanes other = a_larger ? b : a;
  const FloatLanes eighths = radius != 0 ? other / radius : FloatLanes{};
  const SinCosResult<FloatLanes> angle = SinCosWithinEighth(0.125f * eighths);
  return {radius * (a_larger ? angle.cos : angle.sin), radius * (a_larger ? angle.sin : angle.cos)};
}

inline Vec3Lanes SampleCosineHemisphere(Vec2Lanes u) {
  const Vec2Lanes d = SampleConcentricDisk(u);
  return {d.x, d.y, Sqrt(Max(FloatLanes{}, Fma(-d.x, d.x, Fma(-d.y, d.y, SameFloat(1)))))};
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
