#pragma once

#include <cstdint>

#include "common/job.h"
#include "worker/math/vec.h"

namespace strata {

/// Dimensions of a path are reserved in pairs, in this order.
enum SamplePair : uint32_t { kPairFilm = 0, kPairLens = 1, kPairTime = 2, kPairFirstBounce = 3 };
/// Pairs of one bounce.
enum BouncePair : uint32_t {
  kPairBsdf = 0,      ///< Direction.
  kPairLobe = 1,      ///< x: lobe; y: material of a mix.
  kPairLight = 2,     ///< Point on the light.
  kPairSelect = 3,    ///< x: which light; y: Russian roulette.
  kPairsPerBounce = 4
};

/// What random numbers depend on, and nothing else (design, section 2).
struct SampleKey {
  uint64_t seed = 0;
  uint32_t frame = 0;
  uint32_t x = 0, y = 0;
  uint32_t replicate = 0;
};

/// Points of one replicate of one pixel. Values are in [0, 1), multiples of 2^-24.
/// Padded two-dimensional Owen-scrambled Sobol' points: in each pair the index is shuffled and both
/// coordinates scrambled by hashes of the key and the pair (Burley 2020, JCGT 9(4), with the hash
/// of Vegdahl 2021). Any prefix of 2^k points is a (0, k, 2)-net in each pair.
class SobolSampler {
 public:
  explicit SobolSampler(const SampleKey& key);
  void StartSample(uint32_t index) { index_ = index; }
  Vec2f Get2D(uint32_t pair) const;

 private:
  uint64_t key_ = 0;
  uint32_t index_ = 0;
};

/// Independent uniform numbers from a counter-based hash of the same key.
class IndependentSampler {
 public:
  explicit IndependentSampler(const SampleKey& key);
  void StartSample(uint32_t index) { index_ = index; }
  Vec2f Get2D(uint32_t pair) const;

 private:
  uint64_t key_ = 0;
  uint32_t index_ = 0;
};

}  // namespace strata
