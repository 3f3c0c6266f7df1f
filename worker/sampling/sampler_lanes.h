#pragma once

#include <array>
#include <vector>

#include "worker/math/lanes.h"
#include "worker/sampling/sampler.h"

namespace strata {

/// Samplers of paths, each on a sample of its own, of which eight at a time give their numbers:
/// those of Sampler itself.
template <typename Sampler>
class SamplerLanes {
 public:
  explicit SamplerLanes(int paths) : samplers_(paths, Sampler(SampleKey{})) {}

  void StartSample(int path, const Sampler& sampler, uint32_t index) {
    samplers_[path] = sampler;
    samplers_[path].StartSample(index);
  }
  /// Lanes are of these paths from now on.
  void Choose(const LanePlaces& paths) { paths_ = paths; }

  /// Of each lane in `mask` its own pair.
  Vec2Lanes Get2D(IntLanes pair, MaskLanes mask) const {
    Vec2Lanes u;
    ForEachLane(mask, [&](int lane) {
      const Vec2f v = samplers_[paths_.at[lane]].Get2D(static_cast<uint32_t>(pair[lane]));
      u.x[lane] = v.x;
      u.y[lane] = v.y;
    });
    return u;
  }

 private:
  std::vector<Sampler> samplers_;
  LanePlaces paths_ = {};
};

/// Lane by lane the arithmetic of SobolSampler, which has four pairs side by side instead.
template <>
class SamplerLanes<SobolSampler> {
 public:
  explicit SamplerLanes(int paths) : states_(paths) {}

  void StartSample(int path, const SobolSampler& sampler, uint32_t index) {
    states_[path] = {static_cast<uint32_t>(sampler.key()),
                     static_cast<uint32_t>(sampler.key() >> 32), ReverseBits(index)};
  }
  void Choose(const LanePlaces& paths) {
    LanePlaces places;
    for (int lane = 0; lane < kLanes; ++lane)
      places.at[lane] = paths.at[lane] * static_cast<int32_t>(sizeof(State) / sizeof(float));
    const RowLanes rows = LoadRows(reinterpret_cast<const float*>(states_.data()), places);
    key_low_ = reinterpret_cast<Words8>(rows.v[0]);
    key_high_ = reinterpret_cast<Words8>(rows.v[1]);
    reversed_index_ = reinterpret_cast<Words8>(rows.v[2]);
  }

  Vec2Lanes Get2D(IntLanes pairs, MaskLanes /*mask*/) const {
    const Words8 pair = reinterpret_cast<Words8>(pairs);
    const Words8 index = ReverseBits(OwenScrambleReversed(reversed_index_, Seed(pair, 2)));
    return {Fraction(OwenScrambleReversed(index, Seed(pair, 0))),
            Fraction(OwenScrambleReversed(SobolSecondReversed(index), Seed(pair, 1)))};
  }

 private:
  struct alignas(16) State {
    uint32_t key_low = 0, key_high = 0, reversed_index = 0, padding = 0;
  };
  Words8 Seed(Words8 pair, uint32_t use) const {
    return ScrambleSeed(key_low_, key_high_, pair, Words8{} + use);
  }
  static FloatLanes Fraction(Words8 reversed) {
    return ToFloat(reinterpret_cast<IntLanes>(ReverseBits(reversed) >> 8)) * 0x1p-24f;
  }

  std::vector<State> states_;
  Words8 key_low_ = {}, key_high_ = {}, reversed_index_ = {};
};

}  // namespace strata
