#pragma once

#include <array>
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
  kPairSelect = 3,  ///< x: which light; y: Russian roulette, of shadow rays too.
  kPairsPerBounce = 4
};
/// One for each ray that is sent through media, beyond those of all bounces. x: distance; y: colour
/// channel.
inline constexpr uint32_t kPairFirstFlight = 1u << 20;

/// What random numbers depend on, and nothing else (design, section 2).
struct SampleKey {
  uint64_t seed = 0;
  uint32_t frame = 0;
  uint32_t x = 0, y = 0;
  uint32_t replicate = 0;
  SamplerKind kind = SamplerKind::kSobol;  ///< Which of several a PatternSampler is; not hashed.

  uint64_t Hash() const {
    uint64_t hash = HashCombine(0, seed);
    hash = HashCombine(hash, (uint64_t{frame} << 32) | replicate);
    return HashCombine(hash, (uint64_t{x} << 32) | y);
  }
};

/// Points of one replicate of one pixel. Values are in [0, 1), multiples of 2^-24.
/// Padded two-dimensional Owen-scrambled Sobol' points: in each pair the index is shuffled and both
/// coordinates scrambled by hashes of the key and the pair (PBRT 8.7.5; Burley 2020, JCGT 9(4),
/// with the hash of Vegdahl 2021). Any prefix of 2^k points is a (0, k, 2)-net in each pair.
///
/// The four pairs of a bounce are made at once in one vector and kept: a sampler belongs to one
/// thread.
class SobolSampler {
 public:
  explicit SobolSampler(const SampleKey& key) : key_(key.Hash()) {}
  uint64_t key() const { return key_; }
  void StartSample(uint32_t index) {
    reversed_index_ = ReverseBits(index);
    block_ = kNoBlock;
  }

  Vec2f Get2D(uint32_t pair) const {
    // Bounces start at pair 3, so that blocks begin one pair early.
    static_assert((kPairFirstBounce + 1) % kBlock == 0 && kPairsPerBounce == kBlock);
    const uint32_t block = (pair + 1) / kBlock, place = (pair + 1) % kBlock;
    if (block != block_) MakeBlock(block);
    return {values_[place], values_[kBlock + place]};
  }

 private:
  static constexpr uint32_t kBlock = 4;
  static constexpr uint32_t kNoBlock = 0xffffffffu;

  /// Blocks whose seeds are kept from sample to sample.
  static constexpr uint32_t kKeptBlocks = 8;

  struct Seeds {
    Words4 order;
    Words8 coordinates;
  };
  static Seeds MakeSeeds(uint64_t key, uint32_t block) {
    const Words4 pair = Words4{0, 1, 2, 3} + (block * kBlock - 1);
    const Words8 pairs = __builtin_shufflevector(pair, pair, 0, 1, 2, 3, 4, 5, 6, 7);
    return {ScrambleSeed(key, pair, Words4{2, 2, 2, 2}),
            ScrambleSeed(key, pairs, Words8{0, 0, 0, 0, 1, 1, 1, 1})};
  }
  Seeds SeedsOf(uint32_t block) const {
    if (block >= kKeptBlocks) return MakeSeeds(key_, block);
    // Blocks are first asked for in order, or nearly so.
    for (; kept_ <= block; ++kept_) seeds_[kept_] = MakeSeeds(key_, kept_);
    return seeds_[block];
  }

  void MakeBlock(uint32_t block) const {
    const Seeds seeds = SeedsOf(block);
    const Words4 shuffled = OwenScrambleReversed(Words4{} + reversed_index_, seeds.order);
    const Words4 index = ReverseBits(shuffled);
    // The first Sobol' coordinate is the index with its bits reversed, so its reversal is the
    // index.
    const Words8 points =
        __builtin_shufflevector(index, SobolSecondReversed(index), 0, 1, 2, 3, 4, 5, 6, 7);
    const Words8 digits = ReverseBits(OwenScrambleReversed(points, seeds.coordinates)) >> 8;
    // As signed integers, which these 24 bits are too: their conversion is one instruction.
    using Integers __attribute__((vector_size(32))) = int32_t;
    values_ = __builtin_convertvector(reinterpret_cast<Integers>(digits), Floats) * 0x1p-24f;
    block_ = block;
  }

  using Floats __attribute__((vector_size(32))) = float;

  uint64_t key_ = 0;
  uint32_t reversed_index_ = 0;
  mutable uint32_t block_ = kNoBlock;
  mutable uint32_t kept_ = 0;  ///< How many of seeds_ are made.
  mutable std::array<Seeds, kKeptBlocks> seeds_;
  mutable Floats values_ = {};  ///< x of the block's pairs, then y.
};

/// Independent uniform numbers (PBRT 8.4) from a counter-based hash of the same key.
class IndependentSampler {
 public:
  explicit IndependentSampler(const SampleKey& key) : key_(key.Hash()) {}
  void StartSample(uint32_t index) { sample_ = HashCombine(key_, index); }

  Vec2f Get2D(uint32_t pair) const {
    const uint64_t bits = MixBits(sample_ + pair * 0x9e3779b97f4a7c15u);
    return {static_cast<float>(bits >> 40) * 0x1p-24f,
            static_cast<float>(bits & 0xffffff) * 0x1p-24f};
  }

 private:
  uint64_t key_ = 0;
  uint64_t sample_ = 0;
};

}  // namespace strata
