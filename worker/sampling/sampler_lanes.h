#pragma once

#include <array>
#include <vector>

#include "common/pixel_layout.h"
#include "worker/math/lanes.h"
#include "worker/sampling/sampler.h"

namespace strata {

/// Points of a pixel's replicates, in each lane that of a replicate and sample of its own: the
/// numbers of Sampler itself.
template <typename Sampler>
class SamplerLanes {
 public:
  /// The replicate of `key` is not looked at.
  explicit SamplerLanes(const SampleKey& key) {
    for (uint32_t r = 0; r < kReplicates; ++r)
      replicates_.push_back(Sampler({key.seed, key.frame, key.x, key.y, r}));
    lanes_.assign(kLanes, replicates_.front());
  }

  void StartSample(int lane, uint32_t replicate, uint32_t index) {
    lanes_[lane] = replicates_[replicate];
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
  std::vector<Sampler> replicates_, lanes_;
};

/// Lane by lane the arithmetic of SobolSampler, which has four pairs side by side instead.
template <>
class SamplerLanes<SobolSampler> {
 public:
  explicit SamplerLanes(const SampleKey& key) {
    for (uint32_t r = 0; r < kReplicates; ++r)
      keys_[r] = SampleKey{key.seed, key.frame, key.x, key.y, r}.Hash();
  }

  void StartSample(int lane, uint32_t replicate, uint32_t index) {
    key_low_[lane] = static_cast<uint32_t>(keys_[replicate]);
    key_high_[lane] = static_cast<uint32_t>(keys_[replicate] >> 32);
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

  std::array<uint64_t, kReplicates> keys_;
  Words8 key_low_ = {}, key_high_ = {}, reversed_index_ = {};
};

}  // namespace strata
