#pragma once

#include <immintrin.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "worker/light/light_bounds.h"
#include "worker/light/light_lanes.h"

// Up to four lights or groups of lights side by side, weighed for a point at once; or for two
// points, in vectors of eight, four lights or groups of each point's own.

namespace strata {

using Floats4 __attribute__((vector_size(16))) = float;

/// Squares of distances are kept within float's range, and all weights above 0.
inline constexpr float kLeastDistance2 = 1e-36f, kMostDistance2 = 1e36f, kLeastWeight = 1e-37f;

template <typename Floats>
struct LightGroupOf {
  Floats x = {}, y = {}, z = {};  ///< Centres.
  Floats radius2 = {};            ///< Of spheres around what is there.
  Floats axis_x = {}, axis_y = {}, axis_z = {};
  Floats cos_spread = {}, sin_spread = {};
  Floats least_facing = {};  ///< Cosine off the cone below which all is dark; or kTwoSided.
  Floats intensity = {};     ///< 0: nothing there.
};

struct LightGroup : LightGroupOf<Floats4> {
  /// Cosines are known to some roundings: what faces away by no more than this may still give
  /// light, and what faces edge-on keeps a chance.
  static constexpr float kSlack = 1e-3f;
  static constexpr float kTwoSided = -4;

  uint32_t lights[4] = {};  ///< Below each.

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

using strata::Max;
using strata::Min;
using strata::Sqrt;
inline Floats4 Sqrt(Floats4 v) { return _mm_sqrt_ps(v); }
inline Floats4 Max(Floats4 a, Floats4 b) { return _mm_max_ps(b, a); }
inline Floats4 Min(Floats4 a, Floats4 b) { return _mm_min_ps(b, a); }
template <typename Floats>
Floats Abs(Floats v) {
  return Max(v, -v);
}
template <typename Floats>
Floats SinOf(Floats cosine) {
  return Sqrt(Max(Floats{}, 1 - cosine * cosine));
}

/// An angle between 0 and a half turn.
template <typename Floats>
struct Angle {
  Floats sin, cos;
};
/// max(0, a - b).
template <typename Floats>
Angle<Floats> SubClamped(Angle<Floats> a, Angle<Floats> b) {
  const auto none = a.cos > b.cos;
  return {none ? Floats{} : a.sin * b.cos - a.cos * b.sin,
          none ? Floats{} + 1 : a.cos * b.cos + a.sin * b.sin};
}

template <typename Floats>
Floats Facing(Floats cosine, Floats least) {
  return cosine < least ? Floats{} : Max(cosine, Floats{} + LightGroup::kSlack);
}

/// Points of LightReceivers, each beside the lights it is weighed for.
template <typename Floats>
struct Points {
  Floats x, y, z, n_x, n_y, n_z;
  Floats one_sided;  ///< Below 0 where they are.
};

template <typename Floats>
Floats Importance(const LightGroupOf<Floats>& group, const Points<Floats>& point) {
  const auto all = [](float v) { return Floats{} + v; };
  const Floats x = point.x - group.x, y = point.y - group.y, z = point.z - group.z;
  const Floats distance2 =
      Min(Max(x * x + y * y + z * z, all(kLeastDistance2)), all(kMostDistance2));
  const Floats inverse2 = 1 / Max(distance2, group.radius2), inverse = Sqrt(1 / distance2);
  const Floats sin_size2 = group.radius2 * inverse2;  // 1 within the sphere.
  const Angle<Floats> size = {Sqrt(sin_size2), Sqrt(Max(Floats{}, 1 - sin_size2))};

  Floats cosine = (group.axis_x * x + group.axis_y * y + group.axis_z * z) * inverse;
  cosine = group.least_facing > LightGroup::kTwoSided ? cosine : Abs(cosine);
  const Angle<Floats> off_axis =
      SubClamped<Floats>({SinOf(cosine), cosine}, {group.sin_spread, group.cos_spread});
  const Floats facing = Facing(SubClamped(off_axis, size).cos, group.least_facing);

  Floats incident = -(point.n_x * x + point.n_y * y + point.n_z * z) * inverse;
  incident = point.one_sided < 0 ? incident : Abs(incident);
  const Floats lit =
      Facing(SubClamped<Floats>({SinOf(incident), incident}, size).cos, all(-LightGroup::kSlack));
  const Floats outside = group.intensity * facing * lit * inverse2;
  const Floats weight = distance2 > group.radius2 ? outside : group.intensity * inverse2;
  const Floats seen = distance2 > group.radius2 ? Min(facing, lit) : all(1);
  return seen > 0 && group.intensity > 0 ? Max(weight, all(kLeastWeight)) : Floats{};
}

}  // namespace light_group_detail

/// How much light may come from each, but for what hides it: never 0 where some does. Conty Estevez
/// and Kulla 2018 with the sphere around the box, and PBRT 12.6.3 for the point's own cosine.
inline Floats4 Importance(const LightGroup& group, const LightReceiver& receiver) {
  const auto all = [](float v) { return Floats4{v, v, v, v}; };
  const light_group_detail::Points<Floats4> point = {all(receiver.p.x),
                                                     all(receiver.p.y),
                                                     all(receiver.p.z),
                                                     all(receiver.n.x),
                                                     all(receiver.n.y),
                                                     all(receiver.n.z),
                                                     all(receiver.one_sided ? -1.0f : 1.0f)};
  return light_group_detail::Importance<Floats4>(group, point);
}

/// The same for two of the receivers, each with a group of its own: the first four weights are
/// those of `first`.
inline FloatLanes Importance(const LightGroup& first_group, const LightGroup& second_group,
                             const LightReceiverLanes& receivers, int first, int second) {
  using Group = LightGroupOf<Floats4>;
  const auto both = [&](const Floats4 Group::*member) -> FloatLanes {
    return _mm256_set_m128(second_group.*member, first_group.*member);
  };
  const __m256i lanes =
      _mm256_set_epi32(second, second, second, second, first, first, first, first);
  const auto of = [&](FloatLanes v) -> FloatLanes { return _mm256_permutevar8x32_ps(v, lanes); };
  const LightGroupOf<FloatLanes> group = {both(&Group::x),          both(&Group::y),
                                          both(&Group::z),          both(&Group::radius2),
                                          both(&Group::axis_x),     both(&Group::axis_y),
                                          both(&Group::axis_z),     both(&Group::cos_spread),
                                          both(&Group::sin_spread), both(&Group::least_facing),
                                          both(&Group::intensity)};
  const FloatLanes sides = receivers.one_sided ? SameFloat(-1) : SameFloat(1);
  return light_group_detail::Importance<FloatLanes>(
      group, {of(receivers.p.x), of(receivers.p.y), of(receivers.p.z), of(receivers.n.x),
              of(receivers.n.y), of(receivers.n.z), of(sides)});
}

}  // namespace strata
