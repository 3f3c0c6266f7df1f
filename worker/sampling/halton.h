#pragma once

#include <cstdint>

#include "worker/math/vec.h"
#include "worker/sampling/sampler.h"

// Halton points (PBRT 8.6): coordinate d of point i is the radical inverse of i in the d-th prime,
// its digits mirrored at the point. Fractions here are whole numbers of 2^-24.

namespace strata {

/// Coordinates with a prime of their own: those of 127 bounces. What lies beyond is independent.
inline constexpr uint32_t kHaltonDimensions = 1024;
/// The prime of a coordinate below kHaltonDimensions: 2, 3, 5, ...
uint32_t HaltonBase(uint32_t dimension);
/// The first of the two coordinates of a pair. Lens and time, which most scenes have no use for,
/// stand behind the first bounce, so that this has the smaller primes.
constexpr uint32_t HaltonDimension(uint32_t pair) {
  return 2 * (pair == 0 || pair > 6 ? pair : (pair + 3) % 6 + 1);
}

/// The radical inverse, rounded up to 2^-24 so that no point falls below the elementary interval it
/// begins; at most 1 - 2^-24. `index` below 2^36.
uint32_t RadicalInverse(uint32_t base, uint64_t index);
/// The same with its digits, zeros too, permuted down to 2^-32: each by x -> a x + b modulo the
/// base, where a and b come from a hash of `key` and the digits before it. For prime bases any two
/// digits go to any other two alike, which is all of Owen's nested scramble that a variance can
/// tell (Matousek 1998, "On the L2-discrepancy for anchored boxes"; Owen 2003, "Variance with
/// Alternative Scramblings of Digital Nets"). Uniform for any index.
uint32_t ScrambledRadicalInverse(uint32_t base, uint64_t index, uint64_t key);

/// Scrambled anew for each coordinate of each replicate of each pixel (PBRT 8.6.3 with Owen's
/// scramble). b1^j b2^k points from a multiple of that number on have one in each elementary
/// interval of the pair's bases b1 and b2.
class HaltonSampler {
 public:
  explicit HaltonSampler(const SampleKey& key) : key_(key.Hash()), beyond_(key) {}
  void StartSample(uint32_t index) {
    index_ = index;
    beyond_.StartSample(index);
  }
  Vec2f Get2D(uint32_t pair) const;

 private:
  uint64_t key_;
  uint32_t index_ = 0;
  IndependentSampler beyond_;
};

/// The bare sequence, the same for all seeds, frames and pixels. Sample i of replicate r is its
/// point 8 i + r, so that a pixel's samples together are the first points there are, and replicates
/// are not independent: each has a part of the plane to itself.
class PlainHaltonSampler {
 public:
  explicit PlainHaltonSampler(const SampleKey& key) : replicate_(key.replicate), beyond_(key) {}
  void StartSample(uint32_t index) {
    point_ = uint64_t{index} * kReplicates + replicate_;
    beyond_.StartSample(index);
  }
  Vec2f Get2D(uint32_t pair) const;

 private:
  uint32_t replicate_;
  uint64_t point_ = 0;
  IndependentSampler beyond_;
};

}  // namespace strata
