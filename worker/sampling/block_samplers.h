#pragma once

#include <cstdint>

#include "worker/math/vec.h"
#include "worker/sampling/sampler.h"

// Patterns of 16 points in the square that are no better for a part of them. They have no prefix
// property, so each 16 consecutive samples of a replicate are a block with a pattern of its own in
// each pair, from a hash of (key, block, pair): independent from block to block and from pair to
// pair, each point uniform, taken in random order.

namespace strata {

inline constexpr uint32_t kBlockSamples = 16;

/// A permutation of 0 ... 15, the k-th in bits [4 k, 4 k + 4), each about as likely (Fisher and
/// Yates, from one random word).
uint64_t RandomOrder16(uint64_t bits);

/// What the samplers of blocks have in common.
class BlockSampler {
 public:
  void StartSample(uint32_t index) {
    block_ = HashCombine(key_, index / kBlockSamples);
    place_ = index % kBlockSamples;
  }

 protected:
  explicit BlockSampler(const SampleKey& key) : key_(key.Hash()) {}
  /// Random bits of the block's pair, from which all of its pattern is drawn.
  uint64_t PatternBits(uint32_t pair) const {
    return MixBits(block_ + pair * uint64_t{0x9e3779b97f4a7c15});
  }
  uint32_t place() const { return place_; }

 private:
  uint64_t key_;
  uint64_t block_ = 0;
  uint32_t place_ = 0;
};

/// Jittered: one point, anywhere, in each cell of a 4x4 grid (PBRT 8.5).
class StratifiedSampler : public BlockSampler {
 public:
  explicit StratifiedSampler(const SampleKey& key) : BlockSampler(key) {}
  Vec2f Get2D(uint32_t pair) const;
};

/// One point in each of 16 columns and in each of 16 rows (PBRT 3rd ed. 7.3; McKay, Beckman and
/// Conover 1979).
class LatinHypercubeSampler : public BlockSampler {
 public:
  explicit LatinHypercubeSampler(const SampleKey& key) : BlockSampler(key) {}
  Vec2f Get2D(uint32_t pair) const;
};

/// No two points nearer than kPoissonDistance, where the square's opposite edges meet: one of
/// kPoissonPatterns patterns found by throwing darts (PBRT 2nd ed., chapter 7), turned, mirrored
/// and shifted at random.
class PoissonDiskSampler : public BlockSampler {
 public:
  explicit PoissonDiskSampler(const SampleKey& key) : BlockSampler(key) {}
  Vec2f Get2D(uint32_t pair) const;
};

/// 0.7 of the distance of the densest pattern of 16 points, sqrt(2 / (16 sqrt 3)); darts alone get
/// to about 0.77 of it.
inline constexpr double kPoissonDistance = 0.19;
inline constexpr uint32_t kPoissonPatterns = 64;

}  // namespace strata
