#pragma once

#include "worker/math/lanes.h"

namespace strata {

/// BsdfValues side by side.
struct BsdfValueLanes {
  RgbLanes f;  ///< Times |cos theta_i|.
  FloatLanes pdf = {};
};

/// BsdfSamples side by side.
struct BsdfSampleLanes {
  Vec3Lanes wi;
  RgbLanes weight;
  FloatLanes pdf = {};
  MaskLanes delta = {}, valid = {};
};

}  // namespace strata
