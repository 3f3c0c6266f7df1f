#pragma once

#include "worker/math/vec.h"

namespace strata {

/// A direction drawn from a BSDF.
struct BsdfSample {
  Vec3f wi;       ///< Local, unit.
  Rgb weight;     ///< f |cos theta_i| / pdf.
  float pdf = 0;  ///< Per solid angle, over all lobes; the probability of the lobe for delta.
  float eta = 1;  ///< Index behind over index before the surface when refracted, else 1.
  bool delta = false;
  bool transmission = false;
  bool to_lamp = false;  ///< A guide drew it, on its way to a lamp.
};

/// Eval and Pdf of one pair of directions.
struct BsdfValue {
  Rgb f;  ///< Times |cos theta_i|.
  float pdf = 0;
};

}  // namespace strata
