#include "worker/sampling/halton.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace strata {
namespace {

constexpr uint32_t kOne = 1u << 24;

constexpr std::array<uint32_t, kHaltonDimensions> FirstPrimes() {
  std::array<uint32_t, kHaltonDimensions> primes = {};
  uint32_t found = 0;
  for (uint32_t n = 2; found < kHaltonDimensions; ++n) {
    bool prime = true;
    for (uint32_t i = 0; prime && i < found && primes[i] * primes[i] <= n; ++i)
      prime = n % primes[i] != 0;
    if (prime) primes[found++] = n;
  }
  return primes;
}

const std::array<uint32_t, kHaltonDimensions> kPrimes = FirstPrimes();

Vec2f Fractions(uint32_t x, uint32_t y) {
  return {static_cast<float>(x) * 0x1p-24f, static_cast<float>(y) * 0x1p-24f};
}

/// A number below n, from 32 random bits.
uint32_t Below(uint32_t n, uint32_t bits) {
  return static_cast<uint32_t>((uint64_t{bits} * n) >> 32);
}

}  // namespace

uint32_t HaltonBase(uint32_t dimension) { return kPrimes[dimension]; }

uint32_t RadicalInverse(uint32_t base, uint64_t index) {
  uint64_t mirrored = 0;
  double scale = kOne;
  for (; index > 0; index /= base) {
    mirrored = mirrored * base + index % base;
    scale /= base;
  }
  return std::min(static_cast<uint32_t>(std::ceil(static_cast<double>(mirrored) * scale)),
                  kOne - 1);
}

uint32_t ScrambledRadicalInverse(uint32_t base, uint64_t index, uint64_t key) {
  constexpr double kLeast = 0x1p-32;
  const double step = 1.0 / base;
  double value = 0;
  uint64_t node = MixBits(key);
  for (double scale = step;; scale *= step) {
    const uint32_t digit = static_cast<uint32_t>(index % base);
    index /= base;
    const uint32_t a = 1 + Below(base - 1, static_cast<uint32_t>(node >> 32));
    const uint32_t b = Below(base, static_cast<uint32_t>(node));
    value += scale * ((a * digit + b) % base);
    if (scale < kLeast) break;
    node = MixBits(node ^ ((digit + 1) * 0x9e3779b97f4a7c15u));
  }
  return std::min(static_cast<uint32_t>(value * kOne), kOne - 1);
}

Vec2f HaltonSampler::Get2D(uint32_t pair) const {
  const uint32_t dimension = HaltonDimension(pair);
  if (dimension >= kHaltonDimensions) return beyond_.Get2D(pair);
  return Fractions(ScrambledRadicalInverse(kPrimes[dimension], index_, key_ + dimension),
                   ScrambledRadicalInverse(kPrimes[dimension + 1], index_, key_ + dimension + 1));
}

Vec2f PlainHaltonSampler::Get2D(uint32_t pair) const {
  const uint32_t dimension = HaltonDimension(pair);
  if (dimension >= kHaltonDimensions) return beyond_.Get2D(pair);
  return Fractions(RadicalInverse(kPrimes[dimension], point_),
                   RadicalInverse(kPrimes[dimension + 1], point_));
}

}  // namespace strata
