// Allocation: what decides a count, what may not, and what it is good for.

#include "coordinator/allocation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <random>

#include "tests/farm/synthetic_image.h"

namespace strata {
namespace {

constexpr uint32_t kSpp = 256;

double Average(const std::vector<uint32_t>& counts) {
  return kReplicates * std::accumulate(counts.begin(), counts.end(), 0.0) /
         static_cast<double>(counts.size());
}

/// A pilot with everything uneven, made by exact arithmetic alone.
PixelStatistics RoughPilot(PlaneSize size) {
  std::mt19937_64 random(5);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  PixelStatistics pilot{size};
  for (size_t i = 0; i < size.Pixels(); ++i) {
    const double u = uniform();
    pilot.samples.push_back(PilotSamples(size, kSpp) / kReplicates);
    pilot.luminance.push_back(u * u * u * u);
    for (Plane& variance : pilot.variance) {
      variance.push_back(uniform() * (i % size.width < 10 ? 4 : 0.25));
    }
    pilot.rays.push_back(2 + 8 * uniform());
    pilot.nonfinite.push_back(0);
  }
  return pilot;
}

/// The pilot with other statistics of one pixel.
PixelStatistics Changed(PixelStatistics pilot, size_t i, double luminance, double variance,
                        double rays) {
  pilot.luminance[i] = luminance;
  for (Plane& channel : pilot.variance) channel[i] = variance;
  pilot.rays[i] = rays;
  pilot.nonfinite[i] ^= 1;
  return pilot;
}

/// Corners, borders, neighbours of borders, inside.
std::vector<size_t> SomePixels(PlaneSize size) {
  std::vector<size_t> pixels;
  for (const size_t y : {size_t{0}, size_t{1}, size_t{2}, size_t{17}, size.height - 1}) {
    for (const size_t x : {size_t{0}, size_t{2}, size_t{9}, size_t{20}, size.width - 1}) {
      pixels.push_back(y * size.width + x);
    }
  }
  return pixels;
}

TEST(PilotTest, IsAQuarterAndAtLeast32) {
  const PlaneSize size{64, 64};
  EXPECT_EQ(PilotSamples(size, 24), 24u);
  EXPECT_EQ(PilotSamples(size, 32), 32u);
  EXPECT_EQ(PilotSamples(size, 40), 32u);
  EXPECT_EQ(PilotSamples(size, 256), 64u);
  EXPECT_EQ(PilotSamples(size, 264), 72u) << "66, rounded up to a multiple of 8";
  EXPECT_EQ(PilotSamples(size, kMaxSpp), kMaxSpp / 4);
  EXPECT_EQ(PilotSamples({31, 64}, 256), 256u);
  EXPECT_EQ(PilotSamples({64, 31}, 256), 256u);
}

TEST(AllocationTest, FollowsItsDefinition) {
  const PlaneSize size{37, 33};
  const PixelStatistics pilot = RoughPilot(size);
  const std::vector<uint32_t> counts = AllocateByRing(pilot, kSpp);
  const auto distance = [](size_t a, size_t b) { return a > b ? a - b : b - a; };
  const auto inside = [&](size_t i, size_t j) {
    return distance(i % size.width, j % size.width) <= 2 &&
           distance(i / size.width, j / size.width) <= 2;
  };
  const auto share = [&](size_t i, double least) {
    double weighted = 0, rays = 0;
    for (size_t j = 0; j < size.Pixels(); ++j) {
      if (j == i || !inside(i, j)) continue;
      const double relative_to = std::max(pilot.luminance[j], least);
      for (const Plane& channel : pilot.variance)
        weighted += channel[j] / (relative_to * relative_to);
      rays += pilot.rays[j];
    }
    return std::sqrt(weighted / rays);
  };
  for (const size_t i : SomePixels(size)) {
    double luminance = 0, sum = 0, outside = 0;
    for (size_t j = 0; j < size.Pixels(); ++j) {
      if (inside(i, j)) continue;
      luminance += pilot.luminance[j];
      ++outside;
    }
    const double least = 0.05 * luminance / outside;
    for (size_t j = 0; j < size.Pixels(); ++j) {
      if (!inside(i, j)) sum += share(j, least);
    }
    const double expected = 64 + (kSpp - 64) * share(i, least) / (sum / outside);
    EXPECT_NEAR(kReplicates * counts[i], std::min(expected, 8.0 * kSpp), 4 + 0.03 * expected) << i;
  }
}

TEST(AllocationTest, APixelsOwnStatisticsDoNotMoveItsCount) {
  const PlaneSize size{40, 33};
  const PixelStatistics pilot = RoughPilot(size);
  for (const AllocationGoal goal :
       {AllocationGoal::kRelativeError, AllocationGoal::kSquaredError}) {
    const std::vector<uint32_t> ring = AllocateByRing(pilot, kSpp, goal);
    const std::vector<uint32_t> own = AllocateByOwnPixel(pilot, kSpp, goal);
    int others_moved = 0, own_moved = 0;
    for (const size_t i : SomePixels(size)) {
      for (const PixelStatistics& changed :
           {Changed(pilot, i, 0, 0, 0), Changed(pilot, i, 1e30, 1e60, 1e6),
            Changed(pilot, i, 40, 0.1, 1), Changed(pilot, i, 1e-30, 1e30, 3)}) {
        const std::vector<uint32_t> moved = AllocateByRing(changed, kSpp, goal);
        EXPECT_EQ(moved[i], ring[i]) << i;
        others_moved += moved != ring;
        own_moved += AllocateByOwnPixel(changed, kSpp, goal)[i] != own[i];
      }
    }
    EXPECT_GT(others_moved, 90) << "its neighbours' must move";
    EXPECT_GT(own_moved, 90) << "the control must fail";
  }
}

TEST(AllocationTest, StaysBetweenPilotAndCap) {
  PixelStatistics pilot = RoughPilot({64, 64});
  for (Plane& variance : pilot.variance) std::fill(variance.begin(), variance.end(), 0);
  for (const size_t i : {64 * 10 + 10, 64 * 40 + 40}) {
    for (Plane& variance : pilot.variance) variance[i] = 1;
  }
  const std::vector<uint32_t> counts = AllocateByRing(pilot, kSpp);
  EXPECT_EQ(*std::max_element(counts.begin(), counts.end()), kSpp) << "8 N over all replicates";
  EXPECT_EQ(*std::min_element(counts.begin(), counts.end()), kSpp / 4 / kReplicates);
  EXPECT_EQ(counts[64 * 10 + 10], kSpp / 4 / kReplicates) << "its ring has no noise";
  EXPECT_EQ(counts[64 * 10 + 11], kSpp);
}

TEST(AllocationTest, IsUniformWhereNothingIsKnown) {
  const auto all = [](PlaneSize size, uint32_t n) {
    return std::vector<uint32_t>(size.Pixels(), n);
  };
  const PlaneSize size{48, 40}, small{31, 200};
  EXPECT_EQ(AllocateByRing(RoughPilot(small), kSpp), all(small, kSpp / 8));
  EXPECT_EQ(AllocateByRing(RoughPilot(size), 32), all(size, 4));

  PixelStatistics equal = RoughPilot(size);
  std::fill(equal.luminance.begin(), equal.luminance.end(), 0.5);
  std::fill(equal.rays.begin(), equal.rays.end(), 3);
  for (Plane& v : equal.variance) std::fill(v.begin(), v.end(), 0.1);
  EXPECT_EQ(AllocateByRing(equal, kSpp), all(size, kSpp / 8));

  PixelStatistics black = equal;
  std::fill(black.luminance.begin(), black.luminance.end(), 0);
  EXPECT_EQ(AllocateByRing(black, kSpp), all(size, kSpp / 8));
  for (Plane& v : black.variance) std::fill(v.begin(), v.end(), 0);
  EXPECT_EQ(AllocateByRing(black, kSpp), all(size, kSpp / 8));
  EXPECT_EQ(AllocateByOwnPixel(black, kSpp), all(size, kSpp / 8));
}

TEST(AllocationTest, SpendsTheBudget) {
  const SyntheticImage image = UnevenImage(192);
  SyntheticRender render(image, 3);
  render.RenderTo(PilotSamples(image.size(), kSpp) / kReplicates);
  const double average = Average(AllocateByRing(render.Statistics(), kSpp));
  std::printf("realised %.2f of %u\n", average, kSpp);
  EXPECT_NEAR(average, kSpp, 0.03 * kSpp);
}

// The counts follow from exact arithmetic: the same on any machine.
TEST(AllocationTest, HasTheSameBitsEverywhere) {
  uint64_t hash = 0xcbf29ce484222325;
  for (const uint32_t n : AllocateByRing(RoughPilot({70, 50}), kSpp)) {
    hash = (hash ^ n) * 0x100000001b3;
  }
  EXPECT_EQ(hash, 0x26796c9bc35f3996);
}

// ---- what it gains ----

/// Mean squared error if these counts are rendered.
double SquaredError(const SyntheticImage& image, const std::vector<uint32_t>& counts) {
  double sum = 0;
  for (size_t i = 0; i < counts.size(); ++i) {
    sum += image.pixels()[i].Variance() / (kReplicates * counts[i]);
  }
  return sum / static_cast<double>(counts.size());
}

/// Neyman's allocation from true variances, with the same floor, cap and rounding, and `average`
/// samples.
std::vector<uint32_t> Neyman(const std::vector<double>& variances, double average) {
  double low = 0, high = 1e9;
  std::vector<uint32_t> counts(variances.size());
  while (high - low > 1e-6 * high) {
    const double factor = 0.5 * (low + high);
    for (size_t i = 0; i < counts.size(); ++i) {
      const double n = std::clamp(factor * std::sqrt(variances[i]), kSpp / 4.0, 8.0 * kSpp);
      counts[i] = static_cast<uint32_t>(std::floor(n / kReplicates + 0.5));
    }
    (Average(counts) > average ? high : low) = factor;
  }
  return counts;
}

TEST(AllocationTest, RingIsNearlyAsGoodAsKnowingTheVariances) {
  const SyntheticImage image = UnevenImage(96);
  const size_t edge = image.size().width;
  std::vector<double> variances, averaged;
  for (const SyntheticPixel& pixel : image.pixels()) variances.push_back(pixel.Variance());
  for (size_t i = 0; i < variances.size(); ++i) {
    double sum = 0, count = 0;
    for (size_t y = i / edge - std::min<size_t>(i / edge, 2); y < std::min(i / edge + 3, edge); ++y)
      for (size_t x = i % edge - std::min<size_t>(i % edge, 2); x < std::min(i % edge + 3, edge);
           ++x, ++count)
        sum += variances[y * edge + x];
    averaged.push_back(sum / count);
  }
  constexpr int kSeeds = 10;
  double ring = 0, neyman = 0, oracle = 0, own = 0, uniform = 0;
  for (int seed = 0; seed < kSeeds; ++seed) {
    SyntheticRender render(image, static_cast<uint64_t>(seed));
    render.RenderTo(PilotSamples(image.size(), kSpp) / kReplicates);
    const PixelStatistics pilot = render.Statistics();
    const auto counts = AllocateByRing(pilot, kSpp, AllocationGoal::kSquaredError);
    const double average = Average(counts);
    ring += SquaredError(image, counts);
    neyman += SquaredError(image, Neyman(averaged, average));
    oracle += SquaredError(image, Neyman(variances, average));
    const auto greedy = AllocateByOwnPixel(pilot, kSpp, AllocationGoal::kSquaredError);
    own += SquaredError(image, greedy) * Average(greedy) / average;
    uniform += SquaredError(image, std::vector<uint32_t>(counts.size(), kSpp / 8)) * kSpp / average;
  }
  std::printf(
      "squared error, Neyman of 5x5 averages 1: ring %.3f, own pixel %.3f, oracle %.3f, "
      "uniform %.3f\n",
      ring / neyman, own / neyman, oracle / neyman, uniform / neyman);
  EXPECT_LT(ring, 1.15 * neyman);
  EXPECT_GT(uniform, 1.5 * ring);
}

// ---- and what it may not cost ----

struct Bias {
  double mean, error;  ///< In standard errors of a uniform render.
};

using Allocate = std::vector<uint32_t> (*)(const PixelStatistics&, uint32_t, AllocationGoal);

Bias BiasOf(Allocate allocate, AllocationGoal goal) {
  constexpr int kSeeds = 500;
  const SyntheticImage image({32, 32}, [](size_t, size_t) {
    return SyntheticPixel{0.05, 2, 0.1, 0};  // About 26 bright samples of 256.
  });
  std::vector<double> biases;
  for (int seed = 0; seed < kSeeds; ++seed) {
    SyntheticRender render(image, 1000 + static_cast<uint64_t>(seed));
    render.RenderTo(PilotSamples(image.size(), kSpp) / kReplicates);
    render.RenderTo(allocate(render.Statistics(), kSpp, goal));
    double sum = 0;
    for (size_t i = 0; i < image.pixels().size(); ++i) {
      const SyntheticPixel& pixel = image.pixels()[i];
      sum += (render.Mean(i) - pixel.Mean()) / std::sqrt(pixel.Variance() / kSpp);
    }
    biases.push_back(sum / static_cast<double>(image.pixels().size()));
  }
  double mean = 0, squares = 0;
  for (const double bias : biases) mean += bias / kSeeds;
  for (const double bias : biases) squares += (bias - mean) * (bias - mean);
  return {mean, std::sqrt(squares / (kSeeds - 1) / kSeeds)};
}

class AllocationBiasTest : public ::testing::TestWithParam<AllocationGoal> {};
INSTANTIATE_TEST_SUITE_P(Goals, AllocationBiasTest,
                         ::testing::Values(AllocationGoal::kRelativeError,
                                           AllocationGoal::kSquaredError));

// Pixels of a render share normalisers, renders are independent: the error is from these. 3.3 of
// them: p = 0.001.
TEST_P(AllocationBiasTest, RingHasNone) {
  const Bias ring = BiasOf(&AllocateByRing, GetParam());
  std::printf("ring: %.4f +- %.4f standard errors\n", ring.mean, ring.error);
  EXPECT_LT(ring.error, 0.002);
  EXPECT_LT(std::fabs(ring.mean), 3.3 * ring.error);
}

// The control. A dark pilot looks free of noise, and its pixel stays dark; but in need of samples
// if errors count against the luminance, and gets brighter: there the sign is the other.
TEST_P(AllocationBiasTest, ThePixelsOwnSamplesHave) {
  const Bias own = BiasOf(&AllocateByOwnPixel, GetParam());
  std::printf("own pixel: %.4f +- %.4f standard errors\n", own.mean, own.error);
  const double sign = GetParam() == AllocationGoal::kSquaredError ? -1 : 1;
  EXPECT_GT(sign * own.mean, 10 * own.error);
}

}  // namespace
}  // namespace strata
