#pragma once

#include <array>
#include <cstdint>

#include "worker/math/vec.h"
#include "worker/sampling/sampler.h"

namespace strata {

/// The generator of drand48 (POSIX): X' = (a X + c) mod 2^48 with a = 0x5DEECE66D, c = 0xB, the
/// number X' 2^-48, and srand48's seeding.
class Drand48 {
 public:
  static constexpr uint64_t kMultiplier = 0x5DEECE66Du, kIncrement = 0xBu;
  static constexpr uint64_t kPeriod = uint64_t{1} << 48;

  explicit constexpr Drand48(uint32_t seed) : state_((uint64_t{seed} << 16) | 0x330E) {}

  /// The next state, 48 bits; drand48 returns it as a fraction, 2^-48 times it.
  constexpr uint64_t Next() { return state_ = (kMultiplier * state_ + kIncrement) % kPeriod; }
  /// As `count` calls of Next, in O(log count): a jump by 2^k is another such map, and its square
  /// is the jump by 2^(k+1) (Brown 1994, "Random Number Generation with Arbitrary Strides"). The
  /// period is 2^48, so that count counts modulo that.
  constexpr void Skip(uint64_t count);

 private:
  uint64_t state_;
};

namespace drand48_detail {

struct Jump {
  uint64_t multiplier, increment;
};

constexpr std::array<Jump, 48> MakeJumps() {
  std::array<Jump, 48> jumps = {};
  Jump jump = {Drand48::kMultiplier, Drand48::kIncrement};
  for (Jump& entry : jumps) {
    entry = jump;
    jump = {jump.multiplier * jump.multiplier % Drand48::kPeriod,
            (jump.multiplier + 1) * jump.increment % Drand48::kPeriod};
  }
  return jumps;
}

/// By 2^k numbers.
inline constexpr std::array<Jump, 48> kJumps = MakeJumps();

}  // namespace drand48_detail

constexpr void Drand48::Skip(uint64_t count) {
  count %= kPeriod;
  for (size_t k = 0; count != 0; ++k, count >>= 1) {
    const drand48_detail::Jump& jump = drand48_detail::kJumps[k];
    if (count & 1) state_ = (jump.multiplier * state_ + jump.increment) % kPeriod;
  }
}

/// Numbers of one sequence, that of srand48 with the low 32 bits of the job's seed. Each sample has
/// kSampleNumbers of them, two for a pair in the pairs' order; the samples of a pixel follow one
/// another, sample i of replicate r as the (8 i + r)-th; and pixel n = (frame 2^16 + y) 2^16 + x
/// begins kPixelStride n numbers after the first, modulo the period. Values are the upper 24 bits.
///
/// Nothing is randomized but by the seed: replicates are stretches of one sequence, and neither
/// they nor pixels are independent.
class Drand48Sampler {
 public:
  /// A prime: strides that are multiples of powers of two meet the lattices of such generators (De
  /// Matteis and Pagnutti 1988). Paths of more than 126 bounces run on into the next sample's, and
  /// flights through media (kPairFirstFlight) use those of later ones.
  static constexpr uint64_t kSampleNumbers = 1021;
  /// Odd, and the golden section of the period: pixels' stretches are spread evenly over it.
  static constexpr uint64_t kPixelStride = 0x9e3779b97f4bu;

  explicit Drand48Sampler(const SampleKey& key)
      : pixel_(static_cast<uint32_t>(key.seed)), replicate_(key.replicate) {
    pixel_.Skip((((uint64_t{key.frame} << 16) + key.y) * 0x10000u + key.x) * kPixelStride);
    StartSample(0);
  }
  void StartSample(uint32_t index) {
    sample_ = pixel_;
    sample_.Skip((uint64_t{index} * kReplicates + replicate_) * kSampleNumbers);
  }
  Vec2f Get2D(uint32_t pair) const {
    Drand48 generator = sample_;
    generator.Skip(uint64_t{2} * pair);
    const auto x = static_cast<float>(generator.Next() >> 24);
    return {x * 0x1p-24f, static_cast<float>(generator.Next() >> 24) * 0x1p-24f};
  }

 private:
  Drand48 pixel_;
  uint32_t replicate_;
  Drand48 sample_ = pixel_;
};

}  // namespace strata
