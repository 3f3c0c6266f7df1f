#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>

#include "cli/lab/experiment.h"
#include "common/moments.h"
#include "worker/sampling/sampler.h"

namespace strata::lab {

/// Independent uniform numbers in order, from the renderer's counter-based sampler. Streams of one
/// seed share nothing.
class RandomStream {
 public:
  RandomStream(uint64_t seed, uint32_t stream) : sampler_({.seed = seed, .frame = stream}) {}
  Vec2f Next2D() {
    sampler_.StartSample(count_++);
    return sampler_.Get2D(0);
  }
  float Next() { return Next2D().x; }

 private:
  IndependentSampler sampler_;
  uint32_t count_ = 0;
};

/// Many estimates of one number.
struct Measured {
  Moments moments;
  double seconds = 0;  ///< Of one estimate, on average.

  double Mean() const { return moments.mean; }
  double Variance() const {
    return moments.count > 1 ? moments.m2 / static_cast<double>(moments.count - 1) : 0;
  }
  double StandardError() const {
    return std::sqrt(Variance() / static_cast<double>(moments.count));
  }
};

/// Calls `estimate` so many times and times it.
template <typename Estimate>
Measured Measure(int64_t runs, Estimate&& estimate) {
  Measured measured;
  const auto start = std::chrono::steady_clock::now();
  for (int64_t run = 0; run < runs; ++run) measured.moments.Add(estimate());
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  measured.seconds = passed.count() / static_cast<double>(runs);
  return measured;
}

/// 1 / (V T), the efficiency of an estimator (PBRT 2.2); none where what variance there is comes
/// from rounding, of numbers around 1.
inline double Efficiency(double variance, double seconds, double rounding = 1e-12) {
  return variance > rounding && seconds > 0 ? 1 / (variance * seconds) : kNone;
}

// Titles of columns that experiments share. V is the variance of one estimate, T the seconds it
// takes.
inline constexpr const char* kVariance = "V";
inline constexpr const char* kTheory = "V in theory";
inline constexpr const char* kTime = "T s";
inline constexpr const char* kEfficiency = "1/(V T)";

}  // namespace strata::lab
