#pragma once

#include "worker/math/vec.h"

namespace strata {

/// A point that wants light. What it is lit by depends on no more than this.
struct LightReceiver {
  Vec3f p;
  Vec3f n;                 ///< Unit shading normal; if one_sided, on the side that is seen.
  bool one_sided = false;  ///< Nothing passes through: light from behind n is in vain.
  bool in_medium = false;  ///< A point of a medium, which light reaches from anywhere alike; no n.
  /// The sum of the weights at the light tree's root, where Select has found it; 0: not known.
  float root_sum = 0;
};

/// Where a light, or a group of them, is and where it shines (Conty Estevez and Kulla 2018, with
/// the box's sphere; PBRT 12.6.3). All emit evenly within the cone and, beyond it, at most as
/// Lambert's law says, up to another angle.
struct LightBounds {
  Vec3f min, max;
  Vec3f axis = {0, 0, 1};  ///< Unit: the normals lie in a cone around it.
  float cos_spread = -1;   ///< Of the cone's half-angle; -1: anywhere.
  float cos_emit = 0;      ///< Of the angle off the cone up to which they shine.
  float intensity = 0;     ///< Luminance of the intensity along a normal. Relative.
  bool two_sided = false;

  Vec3f Center() const { return (min + max) * 0.5f; }
};

/// Half-angle of the cone of normals, in radians.
double SpreadAngle(const LightBounds& bounds);
/// The angle off it up to which there is light, in radians.
double EmitAngle(const LightBounds& bounds);
/// What bounds both.
LightBounds Union(const LightBounds& a, const LightBounds& b);

}  // namespace strata
