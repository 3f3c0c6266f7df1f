#include "worker/sampling/drand48.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "tests/statistics/random.h"

namespace strata {
namespace {

constexpr uint32_t kSeeds[] = {0u, 1u, 42u, 0x12345678u, 0x80000001u, 0xffffffffu};

TEST(Drand48, IsTheCLibrarysForTheSameSeed) {
  for (const uint32_t seed : kSeeds) {
    srand48(static_cast<long>(seed));
    Drand48 generator(seed);
    for (int i = 0; i < 1000; ++i)
      ASSERT_EQ(std::ldexp(static_cast<double>(generator.Next()), -48), drand48()) << seed;
  }
}

TEST(Drand48, JumpsWhereTheCLibraryWalks) {
  TestRandom random(3);
  for (const uint32_t seed : kSeeds) {
    for (int i = 0; i < 20; ++i) {
      const uint64_t count = random.Bits() % 20000;
      Drand48 generator(seed);
      generator.Skip(count);
      srand48(static_cast<long>(seed));
      for (uint64_t k = 0; k < count; ++k) drand48();
      for (int k = 0; k < 3; ++k)
        ASSERT_EQ(std::ldexp(static_cast<double>(generator.Next()), -48), drand48())
            << seed << ", " << count;
    }
  }
}

/// Further than anybody walks: jumps add up, and 2^48 of them are none.
TEST(Drand48, JumpsAddUpModuloThePeriod) {
  TestRandom random(4);
  for (int i = 0; i < 1000; ++i) {
    const uint64_t a = random.Bits() >> 16, b = random.Bits() >> 16;
    Drand48 twice(7), once(7), around(7), at_once(7);
    twice.Skip(a);
    twice.Skip(b);
    once.Skip(a + b);
    EXPECT_EQ(twice.Next(), once.Next());
    around.Skip(a);
    around.Skip(Drand48::kPeriod - a);
    EXPECT_EQ(around.Next(), at_once.Next());
  }
}

/// The map from keys to positions, as drand48.h tells it.
TEST(Drand48Sampler, NumbersComeFromTheirPlaceInTheSequence) {
  const SampleKey key = {.seed = 42, .frame = 1, .x = 3, .y = 2, .replicate = 5};
  Drand48Sampler sampler(key);
  for (const uint32_t index : {0u, 1u, 77u}) {
    for (const uint32_t pair : {0u, 3u, 500u}) {
      const uint64_t pixel = (uint64_t{1} << 32) + (2u << 16) + 3;
      Drand48 generator(42);
      generator.Skip(pixel * Drand48Sampler::kPixelStride +
                     (index * 8 + 5) * Drand48Sampler::kSampleNumbers + 2 * pair);
      sampler.StartSample(index);
      const Vec2f p = sampler.Get2D(pair);
      EXPECT_EQ(p.x, static_cast<float>(generator.Next() >> 24) * 0x1p-24f);
      EXPECT_EQ(p.y, static_cast<float>(generator.Next() >> 24) * 0x1p-24f);
    }
  }
  // The first sample of the first pixel begins the sequence.
  srand48(9);
  Drand48Sampler first({.seed = 9});
  for (uint32_t pair = 0; pair < 8; ++pair) {
    const Vec2f p = first.Get2D(pair);
    EXPECT_EQ(p.x, std::floor(drand48() * 0x1p24) * 0x1p-24);
    EXPECT_EQ(p.y, std::floor(drand48() * 0x1p24) * 0x1p-24);
  }
}

/// Pixels of a frame of 1920x1080 have 18,000 samples each before one runs into another's numbers.
TEST(Drand48Sampler, PixelsHaveStretchesOfTheirOwn) {
  std::vector<uint64_t> begins;
  for (uint64_t y = 0; y < 1080; ++y) {
    for (uint64_t x = 0; x < 1920; ++x)
      begins.push_back(((y << 16) + x) * Drand48Sampler::kPixelStride % Drand48::kPeriod);
  }
  std::sort(begins.begin(), begins.end());
  uint64_t least = Drand48::kPeriod - begins.back() + begins.front();
  for (size_t i = 1; i < begins.size(); ++i) least = std::min(least, begins[i] - begins[i - 1]);
  EXPECT_GE(least, 18000 * Drand48Sampler::kSampleNumbers);
}

}  // namespace
}  // namespace strata
