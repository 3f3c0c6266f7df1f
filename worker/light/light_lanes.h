#pragma once

#include "worker/light/light_bounds.h"
#include "worker/light/light_sample.h"
#include "worker/math/lanes.h"

namespace strata {

/// LightReceivers side by side.
struct LightReceiverLanes {
  Vec3Lanes p, n;
  MaskLanes one_sided = {}, in_medium = {};

  LightReceiver Get(int lane) const {
    return {p.Get(lane), n.Get(lane), one_sided[lane] != 0, in_medium[lane] != 0};
  }
};

/// LightSamples side by side.
struct LightSampleLanes {
  Vec3Lanes wi;
  RgbLanes radiance;
  FloatLanes pdf = {};
  MaskLanes delta = {}, infinite = {};
  Vec3Lanes end;
  MaskLanes valid = {};

  void Set(int lane, const LightSample& s) {
    wi.Set(lane, s.wi);
    radiance.Set(lane, s.radiance);
    pdf[lane] = s.pdf;
    delta[lane] = s.delta ? -1 : 0;
    infinite[lane] = s.infinite ? -1 : 0;
    end.Set(lane, s.end);
    valid[lane] = -1;
  }
};

}  // namespace strata
