#pragma once

#include <vector>

#include "worker/math/lanes.h"
#include "worker/sampling/sampler.h"

namespace strata {

/// Samplers side by side, each lane's on a sample of its own: the numbers of Sampler itself.
template <typename Sampler>
class SamplerLanes {
 public:
  void StartSample(int lane, const Sampler& sampler, uint32_t index) {
    lanes_[lane] = sampler;
    lanes_[lane].StartSample(index);
  }

  /// Of each lane in `mask` its own pair.
  Vec2Lanes Get2D(IntLanes pair, MaskLanes mask) const {
    Vec2Lanes u;
    ForEachLane(mask, [&](int lane) {
      const Vec2f v = lanes_[lane].Get2D(static_cast<uint32_t>(pair[lane]));
      u.x[lane] = v.x;
      u.y[lane] = v.y;
    });
    return u;
  }

 private:
  std::vector<Sampler> lanes_ = std::vector<Sampler>(kLanes, Sampler(SampleKey{}));
};

/// Lane by lane the arithmetic of SobolSampler, which has four pairs side by side instead.
template <>
class SamplerLanes<SobolSampler> {
 public:
  void StartSample(int lane, const SobolSampler& sampler, uint32_t index) {
    key_low_[lane] = static_cast<uint32_t>(sampler.key());
    key_high_[lane] = static_cast<uint32_t>(sampler.key() >> 32);
    reversed_index_[lane] = ReverseBits(index);
  }

  Vec2Lanes Get2D(IntLanes pairs, MaskLanes /*mask*/) const {
    const Words8 pair = reinterpret_cast<Words8>(pairs);
    const Words8 index = ReverseBits(OwenScrambleReversed(reversed_index_, Seed(pair, 2)));
    return {Fraction(OwenScrambleReversed(index, Seed(pair, 0))),
            Fraction(OwenScrambleReversed(SobolSecondReversed(index), Seed(pair, 1)))};
  }

 private:
  Words8 Seed(Words8 pair, uint32_t use) const {
    return ScrambleSeed(key_low_, key_high_, pair, Words8{} + use);
  }
  static FloatLanes Fraction(Words8 reversed) {
    return ToFloat(reinterpret_cast<IntLanes>(ReverseBits(reversed) >> 8)) * 0x1p-24f;
  }

  Words8 key_low_ = {}, key_high_ = {}, reversed_index_ = {};
};

}  // namespace strata
