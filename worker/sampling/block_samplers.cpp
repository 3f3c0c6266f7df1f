#include "worker/sampling/block_samplers.h"

#include <array>
#include <utility>

namespace strata {
namespace {

/// A point in units of 2^-24; 32-bit sums of them are reduced to 24.
struct GridPoint {
  uint32_t x, y;
};
constexpr uint32_t kGridMask = (1u << 24) - 1;

Vec2f Fractions(GridPoint p) {
  return {static_cast<float>(p.x) * 0x1p-24f, static_cast<float>(p.y) * 0x1p-24f};
}

uint32_t PlaceIn(uint64_t order, uint32_t k) {
  return static_cast<uint32_t>(order >> (4 * k)) & 15;
}

using PoissonPattern = std::array<GridPoint, kBlockSamples>;

/// Whether `a` and `b` keep their distance on the torus.
bool AreApart(GridPoint a, GridPoint b) {
  constexpr auto kDistance = static_cast<int64_t>(kPoissonDistance * (kGridMask + 1.0)) + 1;
  const auto nearest = [](uint32_t from, uint32_t to) {
    const int64_t d = (to - from) & kGridMask;
    return d > (int64_t{1} << 23) ? (int64_t{1} << 24) - d : d;
  };
  const int64_t dx = nearest(a.x, b.x), dy = nearest(a.y, b.y);
  return dx * dx + dy * dy >= kDistance * kDistance;
}

/// Darts are thrown until 16 stick, from the start again where there seems to be no room left.
PoissonPattern ThrowDarts(uint64_t seed) {
  constexpr int kMostDarts = 2000;
  PoissonPattern pattern;
  while (true) {
    uint32_t count = 0;
    for (int dart = 0; dart < kMostDarts && count < kBlockSamples; ++dart) {
      seed = MixBits(seed + 0x9e3779b97f4a7c15u);
      const GridPoint p = {static_cast<uint32_t>(seed >> 40),
                           static_cast<uint32_t>(seed & kGridMask)};
      bool sticks = true;
      for (uint32_t i = 0; sticks && i < count; ++i) sticks = AreApart(p, pattern[i]);
      if (sticks) pattern[count++] = p;
    }
    if (count == kBlockSamples) return pattern;
  }
}

const std::array<PoissonPattern, kPoissonPatterns>& PoissonPatterns() {
  static const auto patterns = [] {
    std::array<PoissonPattern, kPoissonPatterns> made;
    for (uint32_t i = 0; i < kPoissonPatterns; ++i) made[i] = ThrowDarts(i + 1);
    return made;
  }();
  return patterns;
}

}  // namespace

uint64_t RandomOrder16(uint64_t bits) {
  __extension__ using Product = unsigned __int128;
  uint64_t order = 0xfedcba9876543210u;
  for (uint32_t n = kBlockSamples; n > 1; --n) {
    // The word as a fraction, times n: the whole part is drawn, the rest is still uniform.
    const Product product = Product{bits} * n;
    const auto chosen = static_cast<uint32_t>(product >> 64);
    bits = static_cast<uint64_t>(product);
    const uint32_t a = 4 * (n - 1), b = 4 * chosen;
    const uint64_t difference = ((order >> a) ^ (order >> b)) & 15;
    order ^= (difference << a) | (difference << b);
  }
  return order;
}

Vec2f StratifiedSampler::Get2D(uint32_t pair) const {
  const uint64_t bits = PatternBits(pair);
  const uint32_t cell = PlaceIn(RandomOrder16(bits), place());
  const uint64_t jitter = HashCombine(bits, place());
  constexpr uint32_t kCell = 1u << 22;
  return Fractions({(cell & 3) * kCell + static_cast<uint32_t>(jitter >> 42),
                    (cell >> 2) * kCell + (static_cast<uint32_t>(jitter) & (kCell - 1))});
}

Vec2f LatinHypercubeSampler::Get2D(uint32_t pair) const {
  const uint64_t bits = PatternBits(pair);
  const uint32_t column = PlaceIn(RandomOrder16(bits), place());
  const uint32_t row = PlaceIn(RandomOrder16(HashCombine(bits, kBlockSamples)), place());
  const uint64_t jitter = HashCombine(bits, place());
  constexpr uint32_t kStrip = 1u << 20;
  return Fractions({column * kStrip + static_cast<uint32_t>(jitter >> 44),
                    row * kStrip + (static_cast<uint32_t>(jitter) & (kStrip - 1))});
}

Vec2f PoissonDiskSampler::Get2D(uint32_t pair) const {
  const uint64_t bits = PatternBits(pair);
  const uint64_t more = MixBits(bits + 1);
  const PoissonPattern& pattern = PoissonPatterns()[more % kPoissonPatterns];
  GridPoint p = pattern[PlaceIn(RandomOrder16(bits), place())];
  // The eight symmetries of the square, then a shift.
  if (more & 0x100) p.x = ~p.x;
  if (more & 0x200) p.y = ~p.y;
  if (more & 0x400) std::swap(p.x, p.y);
  const uint64_t shift = MixBits(bits + 2);
  return Fractions({(p.x + static_cast<uint32_t>(shift)) & kGridMask,
                    (p.y + static_cast<uint32_t>(shift >> 32)) & kGridMask});
}

}  // namespace strata
