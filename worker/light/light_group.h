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

/// Squares of distances are kept within float's range, and all weights above 0.
inline constexpr float kLeastDistance2 = 1e-36f, kMostDistance2 = 1e36f, kLeastWeight = 1e-37f;

template <typename Floats>
struct LightGroupOf {
  Floats x = {}, y = {}, z = {};     ///< Centres.
  Floats radius = {}, radius2 = {};  ///< Of spheres around what is there; squared.
  Floats quarter_inverse = {};       ///< 1 / (4 radius)
  Floats axis_x = {}, axis_y = {}, axis_z = {};
  Floats cos_spread = {}, sin_spread = {};
  Floats least_facing = {};  ///< Cosine off the cone below which all is dark; or kTwoSided.
  Floats intensity = {};     ///< 0: nothing there.
  Floats inside = {};        ///< intensity / radius^2, the weight within the sphere.
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
    radius[place] = std::sqrt(
        std::min(1.001f * LengthSquared((bounds.max - bounds.min) * 0.5f), kMostDistance2));
    radius2[place] = radius[place] * radius[place];
    const float inverse = 1 / radius[place];
    quarter_inverse[place] = 0.25f * inverse;
    axis_x[place] = bounds.axis.x;
    axis_y[place] = bounds.axis.y;
    axis_z[place] = bounds.axis.z;
    cos_spread[place] = bounds.cos_spread;
    sin_spread[place] = std::sqrt(std::max(0.0f, 1 - bounds.cos_spread * bounds.cos_spread));
    least_facing[place] = bounds.two_sided ? kTwoSided : bounds.cos_emit - kSlack;
    intensity[place] = bounds.intensity;
    inside[place] = bounds.intensity * (inverse * inverse);
    lights[place] = count;
  }
};

namespace light_group_detail {

using strata::Fma;
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
/// How much of a Lambertian's cosine there is on average over what fills the group's sphere at some
/// distance, times the distance; `along` is that of the sphere's centre. 0 where it is below
/// `least` all over the sphere, else no less than `slack`. `steep` is radius^2 / distance^2.
template <typename Floats>
Floats Facing(Floats along, const LightGroupOf<Floats>& group, Floats steep, Floats least,
              Floats slack) {
  const Floats above = along + group.radius;
  // At least distance cos(max(0, acos(along / distance) - asin(radius / distance))).
  const Floats largest = Fma(Max(Floats{}, -along), steep, above);
  // By Min even where the radius is 0 and its inverse is not finite.
  const Floats mean =
      along < group.radius ? Min(group.radius, above * above * group.quarter_inverse) : along;
  return largest < least ? Floats{} : Max(mean, slack);
}

/// Points of LightReceivers, each beside the lights it is weighed for.
template <typename Floats>
struct Points {
  Floats x, y, z, n_x, n_y, n_z;
  Floats one_sided;  ///< Below 0 where they are, 0 in media, else above.
};

/// What some of the lights and points may be; what none is costs no time.
struct Kinds {
  bool cones = true;            ///< Spreads of more than 0.
  bool two_sided = true;        ///< Lights.
  bool nothing = true;          ///< Places without a light.
  bool lit_from_behind = true;  ///< Points that are not one-sided.
};
template <typename Floats>
[[gnu::always_inline]] inline Floats Importance(const LightGroupOf<Floats>& group,
                                                const Points<Floats>& point, Kinds kinds = {}) {
  const auto all = [](float v) { return Floats{} + v; };
  const Floats x = point.x - group.x, y = point.y - group.y, z = point.z - group.z;
  const Floats distance2 =
      Min(Max(Fma(x, x, Fma(y, y, z * z)), all(kLeastDistance2)), all(kMostDistance2));
  const Floats inverse2 = 1 / distance2, distance = Sqrt(distance2);
  const Floats steep = group.radius2 * inverse2, slack = LightGroup::kSlack * distance;

  Floats along = Fma(group.axis_x, x, Fma(group.axis_y, y, group.axis_z * z));
  if (kinds.two_sided) along = group.least_facing > LightGroup::kTwoSided ? along : Abs(along);
  if (kinds.cones) {
    const Floats off_axis = Sqrt(Max(Floats{}, Fma(-along, along, distance2)));
    along = along > group.cos_spread * distance
                ? distance
                : Fma(along, group.cos_spread, off_axis * group.sin_spread);
  }
  const Floats facing = Facing(along, group, steep, group.least_facing * distance, slack);

  Floats incident = -Fma(point.n_x, x, Fma(point.n_y, y, point.n_z * z));
  if (kinds.lit_from_behind) {
    incident = point.one_sided < 0 ? incident : Abs(incident);
    incident = point.one_sided == 0 ? distance : incident;
  }
  const Floats lit = Facing(incident, group, steep, -slack, slack);
  const Floats outside = group.intensity * (facing * inverse2) * (lit * inverse2);
  const auto within = group.radius2 >= distance2;
  const Floats weight = within ? group.inside : outside;
  const auto seen = within | (Min(facing, lit) > 0);
  const Floats least = Max(weight, all(kLeastWeight));
  if (!kinds.nothing) return seen ? least : Floats{};
  return (seen & (group.intensity > 0)) ? least : Floats{};
}

}  // namespace light_group_detail

/// The same point beside all.
template <typename Floats>
light_group_detail::Points<Floats> PointOf(const LightReceiver& receiver) {
  const auto all = [](float v) { return Floats{} + v; };
  const float one_sided = receiver.one_sided ? -1.0f : receiver.in_medium ? 0.0f : 1.0f;
  return {all(receiver.p.x), all(receiver.p.y), all(receiver.p.z), all(receiver.n.x),
          all(receiver.n.y), all(receiver.n.z), all(one_sided)};
}

/// How much light may come from each, but for what hides it: never 0 where some does. Conty Estevez
/// and Kulla 2018 with the sphere around the box, and PBRT 12.6.3 for the point's own cosine.
inline Floats4 Importance(const LightGroup& group, const LightReceiver& receiver) {
  return light_group_detail::Importance<Floats4>(group, PointOf<Floats4>(receiver));
}

using PointLanes = light_group_detail::Points<FloatLanes>;
inline PointLanes PointsOf(const LightReceiverLanes& receivers) {
  const Vec3Lanes& p = receivers.p;
  const Vec3Lanes& n = receivers.n;
  const FloatLanes two_sided = receivers.in_medium ? FloatLanes{} : SameFloat(1);
  return {p.x, p.y, p.z, n.x, n.y, n.z, receivers.one_sided ? SameFloat(-1) : two_sided};
}

/// Of one place of the group for each of the points. `one_sided`: all points are.
inline FloatLanes Importance(const LightGroup& group, int place, const PointLanes& points,
                             bool one_sided) {
  const auto all = [&](const Floats4& values) {
    return SameFloat(reinterpret_cast<const float*>(&values)[place]);
  };
  const LightGroupOf<FloatLanes> light = {
      all(group.x),          all(group.y),          all(group.z),
      all(group.radius),     all(group.radius2),    all(group.quarter_inverse),
      all(group.axis_x),     all(group.axis_y),     all(group.axis_z),
      all(group.cos_spread), all(group.sin_spread), all(group.least_facing),
      all(group.intensity),  all(group.inside)};
  return light_group_detail::Importance<FloatLanes>(
      light, points,
      {.cones = group.cos_spread[place] < 1,
       .two_sided = !(group.least_facing[place] > LightGroup::kTwoSided),
       .nothing = !(group.intensity[place] > 0),
       .lit_from_behind = !one_sided});
}

/// Of two groups, each beside points of its own.
inline FloatLanes Importance(const LightGroup& first_group, const LightGroup& second_group,
                             const PointLanes& points) {
  using Group = LightGroupOf<Floats4>;
  const auto both = [&](const Floats4 Group::*member) -> FloatLanes {
    return _mm256_set_m128(second_group.*member, first_group.*member);
  };
  const LightGroupOf<FloatLanes> groups = {
      both(&Group::x),          both(&Group::y),          both(&Group::z),
      both(&Group::radius),     both(&Group::radius2),    both(&Group::quarter_inverse),
      both(&Group::axis_x),     both(&Group::axis_y),     both(&Group::axis_z),
      both(&Group::cos_spread), both(&Group::sin_spread), both(&Group::least_facing),
      both(&Group::intensity),  both(&Group::inside)};
  return light_group_detail::Importance<FloatLanes>(groups, points);
}

/// For two of the points, each with a group of its own: the first four weights are those of
/// `first`.
inline FloatLanes Importance(const LightGroup& first_group, const LightGroup& second_group,
                             const PointLanes& points, int first, int second) {
  const IntLanes lanes = {first, first, first, first, second, second, second, second};
  const auto of = [&](FloatLanes v) { return Permute(v, lanes); };
  return Importance(first_group, second_group,
                    PointLanes{of(points.x), of(points.y), of(points.z), of(points.n_x),
                               of(points.n_y), of(points.n_z), of(points.one_sided)});
}

}  // namespace strata
