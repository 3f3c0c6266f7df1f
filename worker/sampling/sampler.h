#pragma once

#include <cstdint>

#include "common/job.h"
#include "worker/math/vec.h"
#include "worker/sampling/hash.h"
#include "worker/sampling/owen_scramble.h"

namespace strata {

/// Dimensions of a path are reserved in pairs, in this order.
enum SamplePair : uint32_t { kPairFilm = 0, kPairLens = 1, kPairTime = 2, kPairFirstBounce = 3 };
/// Pairs of one bounce.
enum BouncePair : uint32_t {
  kPairBsdf = 0,    ///< Direction.
  kPairLobe = 1,    ///< x: lobe; y: material of a mix.
  kPairLight = 2,   ///< Point on the light.
  kPairSelect = 3,  ///< x: which light; y: Russian roulette.
  kPairsPerBounce = 4
};

/// What random numbers depend on, and nothing else (design, section 2).
struct SampleKey {
  uint64_t seed = 0;
  uint32_t frame = 0;
  uint32_t x = 0, y = 0;
  uint32_t replicate = 0;

  uint64_t Hash() const {
    uint64_t hash = HashCombine(0, seed);
    hash = HashCombine(hash, (uint64_t{frame} << 32) | replicate);
    return HashCombine(hash, (uint64_t{x} << 32) | y);
  }
};

/// Points of one replicate of one pixel. Values are in [0, 1), multiples of 2^-24.
/// Padded two-dimensional Owen-scrambled Sobol' points: in each pair the index is shuffled and both
/// coordinates scrambled by hashes of the key and the pair (Burley 2020, JCGT 9(4), with the hash
/// of Vegdahl 2021). Any prefix of 2^k points is a (0, k, 2)-net in each pair.
class SobolSampler {
 public:
  explicit SobolSampler(const SampleKey& key) : key_(key.Hash()) {}
  void StartSample(uint32_t index) { reversed_index_ = ReverseBits(index); }

  Vec2f Get2D(uint32_t pair) const {
    const uint64_t seeds = MixBits(key_ + pair * 0x9e3779b97f4a7c15u);
    const uint32_t index = ReverseBits(
        OwenScrambleReversed(reversed_index_, static_cast<uint32_t>((seeds * kThirdSeed) >> 32)));
    // The first Sobol' coordinate is the index with its bits reversed, so its reversal is the
    // index.
    const uint32_t x = OwenScrambleReversed(index, static_cast<uint32_t>(seeds));
    const uint32_t y =
        OwenScrambleReversed(SobolSecondReversed(index), static_cast<uint32_t>(seeds >> 32));
    return UnitSquareFromReversed(x, y);
  }

 private:
  /// Two seeds are the halves of a hash; the third is the upper half of its product with this.
  static constexpr uint64_t kThirdSeed = 0xa0761d6478bd642fu;

  uint64_t key_ = 0;
  uint32_t reversed_index_ = 0;
};

/// Independent uniform numbers from a counter-based hash of the same key.
class IndependentSampler {
 public:
  explicit IndependentSampler(const SampleKey& key) : key_(key.Hash()) {}
  void StartSample(uint32_t index) { sample_ = HashCombine(key_, index); }

  Vec2f Get2D(uint32_t pair) const {
    const uint64_t bits = MixBits(sample_ + pair * 0x9e3779b97f4a7c15u);
    return {UnitFloat(static_cast<uint32_t>(bits >> 32)), UnitFloat(static_cast<uint32_t>(bits))};
  }

 private:
  uint64_t key_ = 0;
  uint64_t sample_ = 0;
};

}  // namespace strata
