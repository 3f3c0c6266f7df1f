#include "worker/light/light_bounds.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {

double SpreadAngle(const LightBounds& bounds) {
  return Acos(std::clamp(double{bounds.cos_spread}, -1.0, 1.0));
}

double EmitAngle(const LightBounds& bounds) {
  return Acos(std::clamp(double{bounds.cos_emit}, -1.0, 1.0));
}

LightBounds Union(const LightBounds& a, const LightBounds& b) {
  const LightBounds &wide = a.cos_spread <= b.cos_spread ? a : b, &other = &wide == &a ? b : a;
  LightBounds both;
  both.min = Min(a.min, b.min);
  both.max = Max(a.max, b.max);
  both.intensity = a.intensity + b.intensity;
  both.two_sided = a.two_sided || b.two_sided;
  both.cos_emit = both.two_sided ? 0 : std::min(a.cos_emit, b.cos_emit);
  both.axis = wide.axis;
  both.cos_spread = wide.cos_spread;
  if (wide.cos_spread <= -1 || wide.axis == other.axis) return both;

  // The smallest cone around both (PBRT 3.8.4), a little wider for the roundings.
  constexpr double kMargin = 1e-5;
  const Vec3d axis = ToDouble(wide.axis), other_axis = ToDouble(other.axis);
  const double along = Dot(axis, other_axis);
  const Vec3d side = other_axis - axis * (along / Dot(axis, axis));
  const double across = Length(side);
  const double between = Atan2(across, along);
  const double theta_wide = SpreadAngle(wide), theta_other = SpreadAngle(other);
  if (between + theta_other <= theta_wide) return both;
  const double spread = 0.5 * (theta_wide + between + theta_other) + kMargin;
  if (spread >= std::numbers::pi || !(across > 0)) {
    both.cos_spread = -1;
    return both;
  }
  const double turn = spread - theta_wide;
  both.axis = ToFloat(Normalize(axis * Cos(turn) + side * (Sin(turn) / across)));
  both.cos_spread = std::max(static_cast<float>(Cos(spread)) - 0x1p-23f, -1.0f);
  return both;
}

}  // namespace strata
