#pragma once

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "worker/light/light_bounds.h"

// Up to four lights or groups of lights side by side, weighed for a point at once.

namespace strata {

using Floats4 __attribute__((vector_size(16))) = float;

/// Squares of distances are kept within float's range, and all weights above 0.
inline constexpr float kLeastDistance2 = 1e-36f, kMostDistance2 = 1e36f, kLeastWeight = 1e-37f;

struct LightGroup {
  /// Cosines are known to some roundings: what faces away by no more than this may still give
  /// light, and what faces edge-on keeps a chance.
  static constexpr float kSlack = 1e-3f;
  static constexpr float kTwoSided = -4;

  Floats4 x = {}, y = {}, z = {};  ///< Centres.
  Floats4 radius2 = {};            ///< Of spheres around what is there.
  Floats4 axis_x = {}, axis_y = {}, axis_z = {};
  Floats4 cos_spread = {}, sin_spread = {};
  Floats4 least_facing = {};  ///< Cosine off the cone below which all is dark; or kTwoSided.
  Floats4 intensity = {};     ///< 0: nothing there.
  uint32_t lights[4] = {};    ///< Below each.

  void Set(int place, const LightBounds& bounds, uint32_t count) {
    const Vec3f center = bounds.Center();
    x[place] = center.x;
    y[place] = center.y;
    z[place] = center.z;
    // A little more, for the roundings.
    radius2[place] =
        std::min(1.001f * LengthSquared((bounds.max - bounds.min) * 0.5f), kMostDistance2);
    axis_x[place] = bounds.axis.x;
    axis_y[place] = bounds.axis.y;
    axis_z[place] = bounds.axis.z;
    cos_spread[place] = bounds.cos_spread;
    sin_spread[place] = std::sqrt(std::max(0.0f, 1 - bounds.cos_spread * bounds.cos_spread));
    least_facing[place] = bounds.two_sided ? kTwoSided : bounds.cos_emit - kSlack;
    intensity[place] = bounds.intensity;
    lights[place] = count;
  }
};

namespace light_group_detail {

inline Floats4 All(float v) { return Floats4{v, v, v, v}; }
inline Floats4 Sqrt(Floats4 v) { return _mm_sqrt_ps(v); }
inline Floats4 Max(Floats4 a, Floats4 b) { return _mm_max_ps(a, b); }
inline Floats4 Min(Floats4 a, Floats4 b) { return _mm_min_ps(a, b); }
inline Floats4 Abs(Floats4 v) { return Max(v, -v); }
inline Floats4 SinOf(Floats4 cosine) { return Sqrt(Max(All(0), 1 - cosine * cosine)); }

/// An angle between 0 and a half turn.
struct Angle4 {
  Floats4 sin, cos;
};
/// max(0, a - b).
inline Angle4 SubClamped(Angle4 a, Angle4 b) {
  const auto none = a.cos > b.cos;
  return {none ? All(0) : a.sin * b.cos - a.cos * b.sin,
          none ? All(1) : a.cos * b.cos + a.sin * b.sin};
}

inline Floats4 Facing(Floats4 cosine, Floats4 least) {
  return cosine < least ? All(0) : Max(cosine, All(LightGroup::kSlack));
}

}  // namespace light_group_detail

/// How much light may come from each, but for what hides it: never 0 where some does. Conty Estevez
/// and Kulla 2018 with the sphere around the box, and PBRT 12.6.3 for the point's own cosine.
inline Floats4 Importance(const LightGroup& group, const LightReceiver& receiver) {
  using namespace light_group_detail;
  const Floats4 x = receiver.p.x - group.x, y = receiver.p.y - group.y, z = receiver.p.z - group.z;
  const Floats4 distance2 =
      Min(Max(x * x + y * y + z * z, All(kLeastDistance2)), All(kMostDistance2));
  const Floats4 inverse2 = 1 / Max(distance2, group.radius2), inverse = Sqrt(1 / distance2);
  const Floats4 sin_size2 = group.radius2 * inverse2;  // 1 within the sphere.
  const Angle4 size = {Sqrt(sin_size2), Sqrt(Max(All(0), 1 - sin_size2))};

  Floats4 cosine = (group.axis_x * x + group.axis_y * y + group.axis_z * z) * inverse;
  cosine = group.least_facing > LightGroup::kTwoSided ? cosine : Abs(cosine);
  const Angle4 off_axis = SubClamped({SinOf(cosine), cosine}, {group.sin_spread, group.cos_spread});
  const Floats4 facing = Facing(SubClamped(off_axis, size).cos, group.least_facing);

  Floats4 incident = -(receiver.n.x * x + receiver.n.y * y + receiver.n.z * z) * inverse;
  if (!receiver.one_sided) incident = Abs(incident);
  const Floats4 lit =
      Facing(SubClamped({SinOf(incident), incident}, size).cos, All(-LightGroup::kSlack));
  const Floats4 outside = group.intensity * facing * lit * inverse2;
  const Floats4 weight = distance2 > group.radius2 ? outside : group.intensity * inverse2;
  const Floats4 seen = distance2 > group.radius2 ? Min(facing, lit) : All(1);
  return seen > 0 && group.intensity > 0 ? Max(weight, All(kLeastWeight)) : All(0);
}

}  // namespace strata
