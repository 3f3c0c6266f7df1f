#include "worker/sampling/sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"
#include "worker/sampling/block_samplers.h"
#include "worker/sampling/halton.h"

namespace strata {
namespace {

template <typename Sampler>
std::vector<Vec2f> Points(const SampleKey& key, uint32_t pair, uint32_t begin, uint32_t count) {
  Sampler sampler(key);
  std::vector<Vec2f> points;
  for (uint32_t i = begin; i < begin + count; ++i) {
    sampler.StartSample(i);
    points.push_back(sampler.Get2D(pair));
  }
  return points;
}

/// A (0, k, 2)-net has exactly one of its 2^k points in each elementary interval of area 2^-k.
bool IsNet(const std::vector<Vec2f>& points) {
  const uint32_t count = static_cast<uint32_t>(points.size());
  const int k = std::countr_zero(count);
  for (int kx = 0; kx <= k; ++kx) {
    std::vector<bool> taken(count, false);
    for (const Vec2f p : points) {
      const auto x = static_cast<uint32_t>(std::ldexp(p.x, kx));
      const auto y = static_cast<uint32_t>(std::ldexp(p.y, k - kx));
      const uint32_t cell = (x << (k - kx)) | y;
      if (taken[cell]) return false;
      taken[cell] = true;
    }
  }
  return true;
}

TEST(SobolSampler, EveryPrefixOfAPowerOfTwoIsANetInEachPair) {
  for (const uint32_t pair : {0u, 1u, 2u, 7u, 40u, 1000u}) {
    for (uint32_t replicate = 0; replicate < 3; ++replicate) {
      for (int k = 0; k <= 12; ++k) {
        EXPECT_TRUE(IsNet(Points<SobolSampler>({1, 2, 3, 4, replicate}, pair, 0, 1u << k)))
            << "pair " << pair << ", 2^" << k;
      }
    }
  }
}

TEST(SobolSampler, ElementaryBlocksOfTheSequenceAreNets) {
  for (const uint32_t begin : {8u, 24u, 64u, 4096u, 0x80000000u, 0xfffffff8u}) {
    EXPECT_TRUE(IsNet(Points<SobolSampler>({9, 0, 5, 6, 0}, 3, begin, 8))) << begin;
  }
  EXPECT_TRUE(IsNet(Points<SobolSampler>({9, 0, 5, 6, 0}, 3, 0x70000000u, 1024)));
}

TEST(SobolSamplerControl, IndependentPointsAreNoNet) {
  EXPECT_FALSE(IsNet(Points<IndependentSampler>({1, 2, 3, 4, 0}, 0, 0, 64)));
}

template <typename Sampler>
class AnySampler : public testing::Test {};
using Samplers = testing::Types<SobolSampler, IndependentSampler, HaltonSampler, StratifiedSampler,
                                LatinHypercubeSampler, PoissonDiskSampler>;
TYPED_TEST_SUITE(AnySampler, Samplers);

TYPED_TEST(AnySampler, ValuesAreMultiplesOfTwoToMinus24BelowOne) {
  for (const Vec2f p : Points<TypeParam>({1, 0, 0, 0, 0}, 0, 0, 10000)) {
    for (const float v : {p.x, p.y}) {
      ASSERT_GE(v, 0);
      ASSERT_LT(v, 1);
      ASSERT_EQ(v * 0x1p24f, std::floor(v * 0x1p24f));
    }
  }
}

TYPED_TEST(AnySampler, EveryPartOfTheKeyMatters) {
  const SampleKey base = {1, 2, 3, 4, 5};
  std::vector<SampleKey> keys(6, base);
  keys[1].seed = uint64_t{1} << 40;
  keys[2].frame = 3;
  keys[3].x = 4;
  keys[4].y = 3;
  keys[5].replicate = 6;
  std::set<std::pair<float, float>> seen;
  for (const SampleKey& key : keys) {
    for (const uint32_t pair : {0u, 1u}) {
      for (const uint32_t index : {0u, 1u}) {
        const Vec2f p = Points<TypeParam>(key, pair, index, 1)[0];
        EXPECT_TRUE(seen.insert({p.x, p.y}).second);
      }
    }
  }
  const Vec2f a = Points<TypeParam>(base, 0, 0, 1)[0], b = Points<TypeParam>(base, 0, 0, 1)[0];
  EXPECT_EQ(a.x, b.x);
  EXPECT_EQ(a.y, b.y);
  // x and y swapped are another pixel.
  SampleKey swapped = base;
  std::swap(swapped.x, swapped.y);
  EXPECT_NE(Points<TypeParam>(swapped, 0, 0, 1)[0].x, a.x);
}

/// Over pixels and replicates, single points of a given index fill the square evenly, and so do
/// pairs of coordinates that different dimensions, indices or replicates share out.
TYPED_TEST(AnySampler, PointsOverPixelsAreUniformAndUncorrelated) {
  constexpr int kSide = 16, kPixels = 256;
  struct Coordinate {
    uint32_t replicate, index, pair;
    bool second;
  };
  const std::vector<std::pair<Coordinate, Coordinate>> tests = {
      {{0, 0, 0, false}, {0, 0, 0, true}},  {{0, 5, 3, false}, {0, 5, 3, true}},
      {{0, 0, 0, false}, {0, 0, 1, false}}, {{0, 0, 0, true}, {0, 0, 1, true}},
      {{0, 3, 3, false}, {0, 3, 7, false}}, {{0, 0, 3, false}, {1, 0, 3, false}},
      {{0, 7, 3, true}, {1, 7, 3, true}},   {{6, 9, 4, false}, {7, 9, 4, true}},
  };
  for (const auto& [a, b] : tests) {
    std::vector<double> counts(kSide * kSide, 0.0);
    const auto value = [](uint32_t x, uint32_t y, const Coordinate& c) {
      TypeParam sampler({17, 0, x, y, c.replicate});
      sampler.StartSample(c.index);
      const Vec2f p = sampler.Get2D(c.pair);
      return static_cast<int>((c.second ? p.y : p.x) * kSide);
    };
    for (uint32_t y = 0; y < kPixels; ++y) {
      for (uint32_t x = 0; x < kPixels; ++x) ++counts[value(x, y, a) * kSide + value(x, y, b)];
    }
    const std::vector<double> expected(counts.size(), double{kPixels} * kPixels / (kSide * kSide));
    EXPECT_GT(ChiSquareTest(counts, expected).p,
              SidakLevel(0.01, 2 * static_cast<int>(tests.size())))
        << a.index << " " << a.pair << " / " << b.index << " " << b.pair;
  }
}

/// sum over pixels of (estimate - truth)^2 / variance of the estimate, over the number of pixels,
/// where neighbours are summed in blocks first: 1 if they are independent, more if they share
/// numbers.
template <typename PixelEstimate>
double BlockChiSquare(const PixelEstimate& estimate, double variance) {
  constexpr uint32_t kBlocks = 400, kPerBlock = 64;
  double sum = 0;
  for (uint32_t block = 0; block < kBlocks; ++block) {
    double total = 0;
    for (uint32_t i = 0; i < kPerBlock; ++i) total += estimate(block, i) - 0.5;
    sum += total * total / (kPerBlock * variance);
  }
  return sum / kBlocks;
}

// Small sequentially seeded generators overlap between neighbouring pixels, and their errors add up
// instead of averaging out: the measure was 20 where it should be 1.
TYPED_TEST(AnySampler, NeighbouringPixelsAndReplicatesDoNotShareNumbers) {
  constexpr int kSamples = 16;
  const auto estimate = [](const SampleKey& key) {
    TypeParam sampler(key);
    double sum = 0;
    for (int i = 0; i < kSamples; ++i) {
      sampler.StartSample(static_cast<uint32_t>(i));
      sum += sampler.Get2D(3).x;
    }
    return sum / kSamples;
  };
  // The variance of one estimate, from far apart keys.
  MeanWithError square;
  for (uint64_t seed = 0; seed < 20000; ++seed) {
    const double off = estimate({seed * 0x9e3779b97f4a7c15u, 0, 0, 0, 0}) - 0.5;
    square.Add(off * off);
  }
  const double level = SidakLevel(0.01, 4);
  const auto check = [&](const auto& pixel_estimate, const char* what) {
    const double ratio = BlockChiSquare(pixel_estimate, square.mean());
    EXPECT_GT(ChiSquareTail(ratio * 400, 400), level) << what << ": " << ratio;
    EXPECT_GT(1 - ChiSquareTail(ratio * 400, 400), level) << what << ": " << ratio;
  };
  check([&](uint32_t b, uint32_t i) { return estimate({7, 0, i, b, 0}); }, "pixels of a row");
  check([&](uint32_t b, uint32_t i) { return estimate({7, 0, b, 3, i}); }, "replicates");
}

// The same measure on a generator seeded with the pixel's number, whose neighbours are the same
// sequence shifted by one.
TEST(SamplerControl, OverlappingSequencesAreCaught) {
  constexpr int kSamples = 16;
  std::vector<float> sequence;
  TestRandom random(5);
  for (int i = 0; i < 400 * 1000; ++i) sequence.push_back(random.Float());
  const auto estimate = [&](uint32_t block, uint32_t i) {
    double sum = 0;
    for (int s = 0; s < kSamples; ++s) sum += sequence[block * 1000 + i + s];
    return sum / kSamples;
  };
  EXPECT_GT(BlockChiSquare(estimate, 1.0 / 12 / kSamples), 5);
}

/// The mean over keys of the squared error of an integral, for n points.
template <typename Sampler, typename Integrand>
double MeanSquaredError(const Integrand& f, double truth, uint32_t n) {
  double sum = 0;
  constexpr uint32_t kKeys = 400;
  for (uint32_t key = 0; key < kKeys; ++key) {
    double mean = 0;
    for (const Vec2f p : Points<Sampler>({3, 0, key, 0, 0}, 4, 0, n)) mean += f(p);
    sum += (mean / n - truth) * (mean / n - truth);
  }
  return sum / kKeys;
}

// Owen-scrambled nets: variance falls as n^-3 for smooth integrands, n^-1.5 for edges, against n^-1
// (Owen 1997). The bounds leave room for logarithms and noise.
TEST(SobolSampler, VarianceFallsFasterThanForIndependentPoints) {
  const auto smooth = [](Vec2f p) { return std::sin(3.0 * p.x) * std::exp(p.y); };
  const double smooth_truth = (1 - std::cos(3.0)) / 3 * (std::exp(1.0) - 1);
  const auto slope = [](double mse_small, double mse_large) {
    return std::log2(mse_small / mse_large) / 4;
  };
  EXPECT_GT(slope(MeanSquaredError<SobolSampler>(smooth, smooth_truth, 64),
                  MeanSquaredError<SobolSampler>(smooth, smooth_truth, 1024)),
            2.5);
  const auto edge = [](Vec2f p) { return p.x * p.x + p.y * p.y < 1 ? 1.0 : 0.0; };
  const double edge_truth = std::acos(-1.0) / 4;
  EXPECT_GT(slope(MeanSquaredError<SobolSampler>(edge, edge_truth, 64),
                  MeanSquaredError<SobolSampler>(edge, edge_truth, 1024)),
            1.3);
  const double independent = slope(MeanSquaredError<IndependentSampler>(edge, edge_truth, 64),
                                   MeanSquaredError<IndependentSampler>(edge, edge_truth, 1024));
  EXPECT_GT(independent, 0.8);
  EXPECT_LT(independent, 1.2);
}

// Replicates are unbiased: their estimates average to the truth.
TEST(SobolSampler, ReplicateMeansAreUnbiased) {
  const auto f = [](Vec2f p) { return p.x * p.y + (p.x > 0.3f ? 1.0 : 0.0); };
  const double truth = 0.25 + 0.7;
  for (const uint32_t n : {1u, 3u, 8u}) {
    MeanWithError mean;
    for (uint32_t key = 0; key < 20000; ++key) {
      double sum = 0;
      for (const Vec2f p : Points<SobolSampler>({11, 0, key, 1, key % 8}, 5, 0, n)) sum += f(p);
      mean.Add(sum / n);
    }
    // 4.5 standard errors: a level of 1e-5 in all.
    EXPECT_NEAR(mean.mean(), truth, 4.5 * mean.error() + 1e-7) << n;
  }
}

TEST(OwenScramble, IsABijectionWhoseDigitsDependOnThoseBefore) {
  TestRandom random(2);
  for (int i = 0; i < 1000; ++i) {
    const auto v = static_cast<uint32_t>(random.Bits()),
               seed = static_cast<uint32_t>(random.Bits());
    const int digit = static_cast<int>(random.Bits() % 32);
    const uint32_t changed =
        OwenScrambleReversed(v, seed) ^ OwenScrambleReversed(v ^ (1u << digit), seed);
    EXPECT_EQ(std::countr_zero(changed), digit);
  }
}

TEST(OwenScramble, SecondSobolCoordinateIsPascalsTriangle) {
  for (uint32_t index = 0; index < 1000; ++index) {
    uint32_t expected = 0;
    for (int j = 0; j < 32; ++j) {
      uint32_t parity = 0;
      for (uint32_t i = 0; i < 32; ++i) {
        // binomial(i, j) is odd when j's bits are among i's.
        if ((index >> i & 1) && (i & static_cast<uint32_t>(j)) == static_cast<uint32_t>(j))
          parity ^= 1;
      }
      expected |= parity << j;
    }
    ASSERT_EQ(SobolSecondReversed(index), expected) << index;
  }
}

// The vector code against the definition, one word at a time.
TEST(SobolSampler, IsTheScrambledSobolPointOfTheShuffledIndex) {
  TestRandom random(3);
  for (int i = 0; i < 2000; ++i) {
    const SampleKey key = {random.Bits(), 1, static_cast<uint32_t>(i), 2, 3};
    const auto pair = static_cast<uint32_t>(random.Bits() % 100);
    const auto index = static_cast<uint32_t>(random.Bits() >> (32 + i % 32));
    const auto seed = [&](uint32_t use) { return ScrambleSeed(key.Hash(), pair, use); };
    const auto scramble = [](uint32_t fraction, uint32_t s) {
      return ReverseBits(OwenScrambleReversed(ReverseBits(fraction), s));
    };
    const uint32_t shuffled = scramble(index, seed(2));
    const uint32_t x = scramble(ReverseBits(shuffled), seed(0));
    const uint32_t y = scramble(ReverseBits(SobolSecondReversed(shuffled)), seed(1));
    const Vec2f p = Points<SobolSampler>(key, pair, index, 1)[0];
    ASSERT_EQ(p.x, static_cast<float>(x >> 8) * 0x1p-24f);
    ASSERT_EQ(p.y, static_cast<float>(y >> 8) * 0x1p-24f);
  }
}

}  // namespace
}  // namespace strata
