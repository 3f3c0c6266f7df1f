#pragma once

#include <cstdint>
#include <random>

#include "worker/math/vec.h"

namespace strata {

/// A generator for tests that shares nothing with the samplers under test. Its numbers are
/// multiples of 2^-24, as theirs are; the standard fixes its bits.
class TestRandom {
 public:
  explicit TestRandom(uint64_t seed) : engine_(seed) {}
  float Float() { return static_cast<float>(engine_() >> 40) * 0x1p-24f; }
  double Double() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  Vec2f Float2() {
    const float x = Float();
    return {x, Float()};
  }
  uint64_t Bits() { return engine_(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace strata
