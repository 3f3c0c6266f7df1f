#include "worker/sampling/pattern_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <vector>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"

// What is special about each sampler, and what all must have; sampler_test.cpp has more of the
// latter.

namespace strata {
namespace {

using Points = std::vector<Vec2f>;

constexpr SamplerKind kPatterns[] = {SamplerKind::kHalton,      SamplerKind::kHaltonPlain,
                                     SamplerKind::kStratified,  SamplerKind::kLatinHypercube,
                                     SamplerKind::kPoissonDisk, SamplerKind::kDrand48};

Points PointsOf(SamplerKind kind, SampleKey key, uint32_t pair, uint32_t begin, uint32_t count) {
  key.kind = kind;
  PatternSampler sampler(key);
  Points points;
  for (uint32_t i = begin; i < begin + count; ++i) {
    sampler.StartSample(i);
    points.push_back(sampler.Get2D(pair));
  }
  return points;
}

/// Whether each cell of a columns x rows grid has one of the points.
bool FillsGrid(const Points& points, uint32_t columns, uint32_t rows) {
  if (points.size() != size_t{columns} * rows) return false;
  std::vector<bool> taken(points.size(), false);
  for (const Vec2f p : points) {
    // In double, where cells' edges are not moved.
    const auto x = static_cast<uint32_t>(double{p.x} * columns);
    const auto y = static_cast<uint32_t>(double{p.y} * rows);
    if (taken[y * columns + x]) return false;
    taken[y * columns + x] = true;
  }
  return true;
}

double TorusDistance(Vec2f a, Vec2f b) {
  const auto nearest = [](double d) { return d - std::round(d); };
  return std::hypot(nearest(double{a.x} - b.x), nearest(double{a.y} - b.y));
}

double LeastDistance(const Points& points) {
  double least = 1;
  for (size_t i = 0; i < points.size(); ++i) {
    for (size_t j = 0; j < i; ++j) least = std::min(least, TorusDistance(points[i], points[j]));
  }
  return least;
}

/// Blocks of all kinds of keys, pairs and places in the sequence.
template <typename Check>
void ForSomeBlocks(SamplerKind kind, const Check& check) {
  for (uint32_t i = 0; i < 200; ++i) {
    const SampleKey key = {i, i / 7, i % 5, 3 * i, i % 8};
    check(PointsOf(kind, key, i % 40, i / 3 * kBlockSamples, kBlockSamples), i);
  }
}

TEST(StratifiedSampler, EachBlockHasOnePointInEachCell) {
  int columns = 0;
  ForSomeBlocks(SamplerKind::kStratified, [&](const Points& points, uint32_t i) {
    EXPECT_TRUE(FillsGrid(points, 4, 4)) << i;
    columns += FillsGrid(points, 16, 1);
  });
  EXPECT_LE(columns, 2) << "by chance one in 13,000";
}

TEST(LatinHypercubeSampler, EachBlockHasOnePointInEachRowAndColumn) {
  int grids = 0;
  ForSomeBlocks(SamplerKind::kLatinHypercube, [&](const Points& points, uint32_t i) {
    EXPECT_TRUE(FillsGrid(points, 16, 1)) << i;
    EXPECT_TRUE(FillsGrid(points, 1, 16)) << i;
    grids += FillsGrid(points, 4, 4);
  });
  EXPECT_LE(grids, 8) << "by chance one in 190";
}

TEST(PoissonDiskSampler, PointsOfABlockKeepTheirDistance) {
  // Shifts are exact; the distance is of numbers of 2^-24.
  ForSomeBlocks(SamplerKind::kPoissonDisk, [](const Points& points, uint32_t i) {
    EXPECT_GE(LeastDistance(points), kPoissonDistance) << i;
  });
  // The controls.
  double largest = 0;
  ForSomeBlocks(SamplerKind::kStratified, [&](const Points& points, uint32_t) {
    largest = std::max(largest, LeastDistance(points));
  });
  EXPECT_LT(largest, kPoissonDistance);
  EXPECT_LT(LeastDistance(PointsOf(SamplerKind::kPoissonDisk, {}, 0, 8, 16)), kPoissonDistance)
      << "two halves of blocks are no pattern";
}

TEST(BlockSamplers, ABlockThatIsNotOneHasNoStructure) {
  for (uint32_t begin : {1u, 8u, 15u}) {
    EXPECT_FALSE(FillsGrid(PointsOf(SamplerKind::kStratified, {}, 3, begin, 16), 4, 4));
    EXPECT_FALSE(FillsGrid(PointsOf(SamplerKind::kLatinHypercube, {}, 3, begin, 16), 16, 1));
  }
}

TEST(RandomOrder16, ArePermutationsAndEachPlaceIsAsLikely) {
  TestRandom random(8);
  constexpr int kOrders = 40000;
  std::vector<double> counts(256, 0.0);
  for (int i = 0; i < kOrders; ++i) {
    const uint64_t order = RandomOrder16(random.Bits());
    uint32_t seen = 0;
    for (uint32_t k = 0; k < 16; ++k) {
      const uint64_t place = (order >> (4 * k)) & 15;
      seen |= 1u << place;
      ++counts[k * 16 + place];
    }
    ASSERT_EQ(seen, 0xffffu);
  }
  EXPECT_GT(ChiSquareTest(counts, std::vector<double>(256, kOrders / 16.0)).p, 0.01);
}

TEST(HaltonSampler, RadicalInversesMirrorTheDigits) {
  EXPECT_EQ(RadicalInverse(2, 6), 3u << 21);  // 110 -> .011
  EXPECT_EQ(RadicalInverse(2, 0), 0u);
  // 5 = 12 in base 3 -> .21 = 7/9, and 1/3, rounded up.
  EXPECT_EQ(RadicalInverse(3, 5), static_cast<uint32_t>(std::ceil(7.0 / 9 * 0x1p24)));
  EXPECT_EQ(RadicalInverse(3, 1), static_cast<uint32_t>(std::ceil(0x1p24 / 3)));
  EXPECT_EQ(RadicalInverse(2, (uint64_t{1} << 30) - 1), (1u << 24) - 1);
  EXPECT_EQ(HaltonBase(0), 2u);
  EXPECT_EQ(HaltonBase(25), 101u);
  EXPECT_EQ(HaltonBase(kHaltonDimensions - 1), 8161u);  // The 1024th prime.
}

TEST(HaltonSampler, PairsHavePrimesOfTheirOwnAndTheFirstBounceTheSmallOnes) {
  std::set<uint32_t> dimensions;
  for (uint32_t pair = 0; pair < kHaltonDimensions / 2; ++pair) {
    EXPECT_EQ(HaltonDimension(pair) % 2, 0u);
    EXPECT_LT(HaltonDimension(pair), kHaltonDimensions);
    EXPECT_TRUE(dimensions.insert(HaltonDimension(pair)).second) << pair;
  }
  EXPECT_EQ(HaltonDimension(kPairFilm), 0u);
  EXPECT_EQ(HaltonDimension(kPairFirstBounce), 2u);
  EXPECT_EQ(HaltonDimension(kPairLens), 10u);
}

/// 2^j 3^k points from a multiple of that on have one in each box of 2^-j x 3^-k.
TEST(HaltonSampler, PointsFillTheElementaryIntervalsOfTheirBases) {
  for (const SamplerKind kind : {SamplerKind::kHalton, SamplerKind::kHaltonPlain}) {
    const bool plain = kind == SamplerKind::kHaltonPlain;
    for (int j = 0; j <= 5; ++j) {
      uint32_t columns = 1u << j, rows = 1;
      for (int k = 0; k <= 4; ++k, rows *= 3) {
        for (const uint32_t block : {0u, 1u, 5u}) {
          Points points;
          if (plain) {  // Its replicates take turns.
            for (uint32_t i = block * columns * rows; i < (block + 1) * columns * rows; ++i)
              points.push_back(PointsOf(kind, {.replicate = i % 8}, 0, i / 8, 1)[0]);
          } else {
            points = PointsOf(kind, {1, 2, 3, 4, 5}, 0, block * columns * rows, columns * rows);
          }
          EXPECT_TRUE(FillsGrid(points, columns, rows)) << j << " " << k << " " << block;
        }
      }
    }
  }
  // The controls: other boxes, other points.
  EXPECT_FALSE(FillsGrid(PointsOf(SamplerKind::kHalton, {}, 0, 0, 72), 9, 8));
  EXPECT_FALSE(FillsGrid(PointsOf(SamplerKind::kDrand48, {}, 0, 0, 72), 8, 9));
}

/// Digits after those of the index are scrambled too: over keys each point is uniform, and so are
/// two points of one replicate beside each other, but for the strata they do not share.
TEST(HaltonSampler, ScramblesAreUniformAndNested) {
  for (const uint32_t base : {2u, 3u, 5u, 43u}) {
    std::vector<double> counts(64, 0.0), low(16, 0.0);
    for (uint64_t key = 0; key < 40000; ++key) {
      const uint32_t a = ScrambledRadicalInverse(base, 7, key);
      ++counts[a >> 18];
      ++low[a & 15];
      // Points that differ in their first digit alone, and in their second, are apart.
      const uint32_t b = ScrambledRadicalInverse(base, 8, key);
      const uint32_t c = ScrambledRadicalInverse(base, 7 + base * (uint64_t{1} + 7 / base), key);
      const auto digit = [&](uint32_t v) { return static_cast<int>(v * 0x1p-24 * base); };
      ASSERT_NE(digit(a), digit(b));
      ASSERT_EQ(digit(a), digit(c));
    }
    EXPECT_GT(ChiSquareTest(counts, std::vector<double>(64, 625.0)).p, 0.001) << base;
    EXPECT_GT(ChiSquareTest(low, std::vector<double>(16, 2500.0)).p, 0.001) << base;
  }
}

TEST(PlainHaltonSampler, IsTheSameForAllPixelsAndSeeds) {
  const Points a = PointsOf(SamplerKind::kHaltonPlain, {1, 2, 3, 4, 5}, 4, 0, 50);
  const Points b = PointsOf(SamplerKind::kHaltonPlain, {9, 8, 7, 6, 5}, 4, 0, 50);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].x, b[i].x);
    EXPECT_EQ(a[i].y, b[i].y);
  }
  EXPECT_NE(a[1].x, PointsOf(SamplerKind::kHaltonPlain, {1, 2, 3, 4, 6}, 4, 1, 1)[0].x);
}

/// Anything that depends on more than (key, index, pair) would break the farm's equal bits.
TEST(PatternSampler, NumbersDoNotDependOnTheOrderTheyAreAskedFor) {
  for (const SamplerKind kind : kPatterns) {
    SampleKey key = {5, 1, 10, 20, 3, kind};
    PatternSampler forward(key), backward(key);
    std::vector<Vec2f> values;
    for (uint32_t i = 0; i < 40; ++i) {
      forward.StartSample(i);
      for (uint32_t pair = 0; pair < 30; ++pair) values.push_back(forward.Get2D(pair));
    }
    for (uint32_t i = 40; i-- > 0;) {
      backward.StartSample(i);
      for (uint32_t pair = 30; pair-- > 0;) {
        const Vec2f p = backward.Get2D(pair);
        ASSERT_EQ(p.x, values[i * 30 + pair].x) << ToString(kind);
        ASSERT_EQ(p.y, values[i * 30 + pair].y) << ToString(kind);
      }
    }
  }
}

TEST(PatternSampler, FarBouncesHaveNumbersToo) {
  for (const SamplerKind kind : kPatterns) {
    std::vector<double> counts(16, 0.0);
    for (const Vec2f p : PointsOf(kind, {3, 0, 1, 2, 0}, 3 + 4 * 5000, 0, 4096)) {
      ASSERT_GE(p.x, 0);
      ASSERT_LT(p.x, 1);
      ++counts[static_cast<int>(p.x * 4) * 4 + static_cast<int>(p.y * 4)];
    }
    // Stratified blocks are more even than chance: the test is of one side.
    EXPECT_GT(ChiSquareTest(counts, std::vector<double>(16, 256.0)).p, 0.001) << ToString(kind);
  }
}

/// A smooth function, an edge and a product over two pairs; its integral.
double Integrand(Vec2f a, Vec2f b) {
  return std::exp(a.x + a.y) + (0.81 * b.x + 0.59 * b.y < 0.667 ? 2 : 0) + a.x * b.y;
}
const double kIntegral = [] {
  const double e = std::exp(1.0) - 1;
  // The edge cuts x + y from (0.667/0.81, 0) to (0.0948..., 1).
  const double left = (0.667 - 0.59) / 0.81, right = 0.667 / 0.81;
  return e * e + 2 * 0.5 * (left + right) + 0.25;
}();

double ReplicateMean(const SampleKey& key, uint32_t samples) {
  PatternSampler sampler(key);
  double sum = 0;
  for (uint32_t i = 0; i < samples; ++i) {
    sampler.StartSample(i);
    sum += Integrand(sampler.Get2D(kPairFilm), sampler.Get2D(kPairFirstBounce + kPairLight));
  }
  return sum / samples;
}

struct Claims {
  double coverage;    ///< Of mean +- t(7) stderr.
  double mean_ratio;  ///< Mean stderr^2 over the mean squared error.
  double bias;        ///< In its standard errors.
};

/// Over many pixels of eight replicates.
Claims ClaimsOf(SamplerKind kind, uint32_t samples) {
  constexpr int kPixels = 4000;
  constexpr double kStudent7 = 2.364624251592785;
  double covered = 0, claimed = 0, squares = 0;
  MeanWithError error;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    double mean = 0, sum = 0, means[8];
    for (uint32_t r = 0; r < 8; ++r) {
      means[r] = ReplicateMean({11, 0, pixel % 64, pixel / 64, r, kind}, samples);
      mean += means[r] / 8;
    }
    for (const double m : means) sum += (m - mean) * (m - mean);
    const double stderr_squared = sum / 56, off = mean - kIntegral;
    covered += std::abs(off) <= kStudent7 * std::sqrt(stderr_squared);
    claimed += stderr_squared;
    squares += off * off;
    error.Add(off);
  }
  return {covered / kPixels, claimed / squares, error.mean() / error.error()};
}

TEST(PatternSampler, ReplicatesAreIndependentWhereAnIntervalIsClaimed) {
  for (const SamplerKind kind : kPatterns) {
    if (!ClaimsInterval(kind)) continue;
    for (const uint32_t samples : {5u, 16u, 32u}) {
      const Claims claims = ClaimsOf(kind, samples);
      // Standard errors: 0.003 of the coverage, 0.02 to 0.03 of the ratio.
      EXPECT_NEAR(claims.coverage, 0.95, 0.02) << ToString(kind) << " " << samples;
      EXPECT_NEAR(claims.mean_ratio, 1, 0.12) << ToString(kind) << " " << samples;
      EXPECT_LT(std::abs(claims.bias), 4.5) << ToString(kind) << " " << samples;
    }
  }
}

/// Why no interval is claimed by the bare sequence: eight dependent parts of one good pattern.
TEST(PatternSamplerControl, ReplicatesOfThePlainSequenceAreNotIndependent) {
  const Claims claims = ClaimsOf(SamplerKind::kHaltonPlain, 16);
  EXPECT_GT(claims.mean_ratio, 3);
}

/// Errors of two replicates of a pixel, over pixels: correlation, in its standard errors.
double CorrelationSigmas(SampleKey a, SampleKey b, uint32_t begin_b) {
  constexpr int kPixels = 20000;
  double aa = 0, bb = 0, ab = 0;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    const auto error = [&](SampleKey key, uint32_t begin) {
      key.x = pixel;
      PatternSampler sampler(key);
      double sum = 0;
      for (uint32_t i = begin; i < begin + 4; ++i) {
        sampler.StartSample(i);
        sum += sampler.Get2D(kPairFirstBounce).x - 0.5;
      }
      return sum;
    };
    const double x = error(a, 0), y = error(b, begin_b);
    aa += x * x;
    bb += y * y;
    ab += x * y;
  }
  return ab / std::sqrt(aa * bb) * std::sqrt(double{kPixels});
}

TEST(PatternSampler, ErrorsOfReplicatesAreUncorrelated) {
  for (const SamplerKind kind : kPatterns) {
    if (!ClaimsInterval(kind)) continue;
    for (uint32_t r = 1; r < 8; r += 3)
      EXPECT_LT(std::abs(CorrelationSigmas({2, 0, 0, 1, 0, kind}, {2, 0, 0, 1, r, kind}, 0)), 4)
          << ToString(kind) << " " << r;
  }
  // The control: two parts of one block make up for each other.
  const SampleKey key = {2, 0, 0, 1, 0, SamplerKind::kStratified};
  EXPECT_LT(CorrelationSigmas(key, key, 4), -10);
}

}  // namespace
}  // namespace strata
