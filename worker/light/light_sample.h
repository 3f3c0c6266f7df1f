#pragma once

#include "worker/math/vec.h"

namespace strata {

/// Light that may arrive at a point along one direction, before it is known whether it is blocked.
struct LightSample {
  Vec3f wi;       ///< World, unit, from the point towards the light.
  Rgb radiance;   ///< Incident radiance; for delta lights what stays after pdf = 1 is divided out.
  float pdf = 0;  ///< Per solid angle at the point, given the light; 1 for delta lights.
  bool delta = false;     ///< No other way of sampling can find it.
  bool infinite = false;  ///< At no finite distance: `end` is unset.
  Vec3f end;              ///< Where the shadow segment ends, already off the light's own surface.
};

/// Where a ray met an emissive surface, as the pdf of having sampled that point wants it.
struct EmissionHit {
  Vec3f p, ng;  ///< Unit geometric normal of the outer side.
  Vec3f wi;     ///< Unit, from the point that looks towards the light.
  float distance = 0;
};

}  // namespace strata
