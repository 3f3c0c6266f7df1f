// Merging of partials: accuracy against long double, order, duplicates, bounded waiting.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "coordinator/next_round.h"
#include "coordinator/ordered_merge.h"
#include "coordinator/partial_check.h"
#include "coordinator/pixel_merge.h"
#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

constexpr PixelLayout kOneChannel{1, 0};
using Values = std::array<double, kReplicates + 2>;

/// The samples of one pixel: replicate r's sample i is at [r][i].
using Samples = std::vector<std::vector<double>>;

Samples MakeSamples(size_t per_replicate, double mean, double deviation) {
  Samples samples(kReplicates, std::vector<double>(per_replicate));
  for (int r = 0; r < kReplicates; ++r) {
    for (size_t i = 0; i < per_replicate; ++i) {
      const double u = FakeUniform(7, 0, 0, r, static_cast<uint32_t>(i), 0);
      // Uniform squared is skewed; its variance is 4/45.
      samples[static_cast<size_t>(r)][i] =
          mean + deviation * (u * u - 1.0 / 3) / std::sqrt(4.0 / 45);
    }
  }
  return samples;
}

/// What a worker sends for samples [begin, end) of each replicate.
Values BlockOf(const Samples& samples, size_t begin, size_t end) {
  Values values{};
  Moments all;
  for (int r = 0; r < kReplicates; ++r) {
    Moments replicate;
    for (size_t i = begin; i < end; ++i) {
      all.Add(samples[static_cast<size_t>(r)][i]);
      replicate.Add(samples[static_cast<size_t>(r)][i]);
    }
    values[static_cast<size_t>(kOneChannel.Mean(r, 0))] = replicate.mean;
  }
  values[static_cast<size_t>(kOneChannel.M2(0))] = all.m2;
  values[static_cast<size_t>(kOneChannel.M3(0))] = all.m3;
  return values;
}

/// Largest relative errors of the replicate means and of m2, the means relative to the mean of |x|.
struct Errors {
  double mean = 0, m2 = 0, m3 = 0;
};

Errors ErrorsOf(const Values& merged, const Samples& samples) {
  long double total = 0, absolute = 0, m2 = 0, m3 = 0;
  const long double n = static_cast<long double>(samples[0].size());
  std::array<long double, kReplicates> means{};
  for (size_t r = 0; r < kReplicates; ++r) {
    for (const double x : samples[r]) {
      means[r] += x;
      absolute += std::fabs(x);
    }
    total += means[r];
    means[r] /= n;
  }
  const long double mean = total / (n * kReplicates);
  for (const std::vector<double>& replicate : samples) {
    for (const double x : replicate) {
      const long double d = x - mean;
      m2 += d * d;
      m3 += d * d * d;
    }
  }
  Errors errors;
  for (size_t r = 0; r < kReplicates; ++r) {
    const long double error = std::fabs(merged[r] - means[r]) / (absolute / (n * kReplicates));
    errors.mean = std::max(errors.mean, static_cast<double>(error));
  }
  errors.m2 = static_cast<double>(std::fabs((merged[kReplicates] - m2) / m2));
  errors.m3 = static_cast<double>(std::fabs((merged[kReplicates + 1] - m3) / m3));
  return errors;
}

Errors MergeInBlocks(const Samples& samples, const std::vector<size_t>& lengths) {
  Values merged{};
  size_t begin = 0;
  for (size_t k = 0; begin < samples[0].size(); ++k) {
    const size_t end = std::min(begin + lengths[k % lengths.size()], samples[0].size());
    const Values block = BlockOf(samples, begin, end);
    MergePixel(kOneChannel, static_cast<double>(begin), merged.data(),
               static_cast<double>(end - begin), block.data());
    begin = end;
  }
  return ErrorsOf(merged, samples);
}

class MergeAccuracy : public ::testing::TestWithParam<std::vector<size_t>> {};

TEST_P(MergeAccuracy, StaysNearLongDouble) {
  struct Case {
    double mean_over_deviation, tolerance_m2;
  };
  for (const Case& c : {Case{0, 1e-12}, {1, 1e-12}, {-1e3, 1e-12}, {1e3, 1e-12}, {1e5, 1e-10}}) {
    const Samples samples = MakeSamples(size_t{1} << 15, c.mean_over_deviation * 0.1, 0.1);
    const Errors errors = MergeInBlocks(samples, GetParam());
    EXPECT_LE(errors.mean, 1e-14) << "mean/sd " << c.mean_over_deviation;
    EXPECT_LE(errors.m2, c.tolerance_m2) << "mean/sd " << c.mean_over_deviation;
    EXPECT_LE(errors.m3, 100 * c.tolerance_m2) << "mean/sd " << c.mean_over_deviation;
  }
}

// Lengths per replicate: 32 make blocks of 256 samples, the least that is asked for.
INSTANTIATE_TEST_SUITE_P(Splits, MergeAccuracy,
                         ::testing::Values(std::vector<size_t>{32},
                                           std::vector<size_t>{32, 64, 128},
                                           std::vector<size_t>{1024}, std::vector<size_t>{37, 501},
                                           std::vector<size_t>{32768}));

TEST(MergeAccuracyControl, SumsOfSquaresInFloatFail) {
  const Samples samples = MakeSamples(size_t{1} << 15, 100, 0.1);
  float sum = 0, squares = 0;
  for (const std::vector<double>& replicate : samples) {
    for (const double x : replicate) {
      sum += static_cast<float>(x);
      squares += static_cast<float>(x) * static_cast<float>(x);
    }
  }
  const float n = static_cast<float>(samples.size() * samples[0].size());
  Values naive{};
  naive.fill(sum / n);
  naive[kReplicates] = squares - sum * sum / n;
  EXPECT_GT(ErrorsOf(naive, samples).mean, 1e-14);
  EXPECT_GT(ErrorsOf(naive, samples).m2, 1e-10);
}

// ---- order ----

class OrderedMergeTest : public ::testing::Test {
 protected:
  OrderedMergeTest() {
    spec_.width = spec_.height = 24;
    spec_.crop = {0, 0, 24, 24};
    spec_.tile = 16;
    spec_.spp = 8 * 32 * 5;
    plan_ = std::make_shared<const RoundPlan>(PlanFirstRound(spec_));
  }
  std::unique_ptr<Film> NewFilm() {
    const FilmGeometry geometry{FilmLayer::kPath, plan_->grid, LayoutOf(spec_)};
    return *Film::Create(directory_.path() / "film", geometry);
  }
  Partial Render(uint32_t tile, uint32_t piece) const {
    return FakeRender(spec_, *plan_->Unit({0, tile, piece}));
  }

  TestDirectory directory_;
  JobSpec spec_;
  std::shared_ptr<const RoundPlan> plan_;
};

TEST_F(OrderedMergeTest, GivesTheSameBitsForAnyOrder) {
  std::optional<Digest> expected;
  for (const std::vector<uint32_t>& order :
       {std::vector<uint32_t>{0, 1, 2, 3, 4}, {4, 3, 2, 1, 0}, {2, 2, 0, 4, 1, 0, 3, 3, 4}}) {
    const std::unique_ptr<Film> film = NewFilm();
    OrderedMerge merge(*film, plan_);
    uint64_t samples = 0;
    for (const uint32_t piece : order) {
      for (uint32_t tile = 0; tile < plan_->grid.Count(); ++tile) {
        samples += merge.Add(Render(tile, piece), 8).merged.samples;
      }
    }
    EXPECT_EQ(samples, 24u * 24 * spec_.spp);
    EXPECT_EQ(merge.Waiting(), 0u);
    const Digest digest = film->ResultDigest();
    EXPECT_EQ(digest, expected.value_or(digest));
    expected = digest;
  }
}

TEST_F(OrderedMergeTest, OrderWithoutTheFrontWouldChangeBits) {
  // The control of the test above: merged as they come, the bits differ.
  const std::unique_ptr<Film> film = NewFilm();
  std::vector<Digest> digests;
  for (const std::vector<uint32_t>& order :
       {std::vector<uint32_t>{0, 1, 2, 3, 4}, {4, 3, 2, 1, 0}}) {
    const std::unique_ptr<Film> naive = NewFilm();
    for (const uint32_t piece : order) naive->Merge(Render(0, piece), {});
    digests.push_back(naive->ResultDigest());
  }
  EXPECT_NE(digests[0], digests[1]);
}

TEST_F(OrderedMergeTest, KeepsNoMoreThanTheWindow) {
  const std::unique_ptr<Film> film = NewFilm();
  OrderedMerge merge(*film, plan_);
  EXPECT_EQ(merge.Add(Render(0, 3), 3).outcome, OrderedMerge::Outcome::kTooEarly);
  EXPECT_EQ(merge.Add(Render(0, 2), 3).outcome, OrderedMerge::Outcome::kWaiting);
  EXPECT_EQ(merge.Add(Render(0, 2), 3).outcome, OrderedMerge::Outcome::kKnown);
  EXPECT_EQ(merge.Add(Render(0, 1), 3).outcome, OrderedMerge::Outcome::kWaiting);
  EXPECT_EQ(merge.Waiting(), 2u);
  const OrderedMerge::Result result = merge.Add(Render(0, 0), 3);
  EXPECT_EQ(result.outcome, OrderedMerge::Outcome::kMerged);
  EXPECT_EQ(result.merged.units, 3u);
  EXPECT_EQ(result.front, 3u);
  EXPECT_EQ(merge.Waiting(), 0u);
  EXPECT_EQ(merge.Add(Render(0, 1), 3).outcome, OrderedMerge::Outcome::kKnown);
}

TEST_F(OrderedMergeTest, GoesOnFromTheFilmsFront) {
  const std::unique_ptr<Film> film = NewFilm();
  OrderedMerge(*film, plan_).Add(Render(1, 0), 4);
  OrderedMerge again(*film, plan_);
  EXPECT_EQ(again.Add(Render(1, 0), 4).outcome, OrderedMerge::Outcome::kKnown);
  EXPECT_EQ(again.Add(Render(1, 1), 4).outcome, OrderedMerge::Outcome::kMerged);
}

// ---- what is refused ----

TEST_F(OrderedMergeTest, RefusesPartialsThatAreNotTheUnits) {
  const WorkUnit unit = *plan_->Unit({0, 1, 2});
  const PixelLayout layout = LayoutOf(spec_);
  const Partial good = FakeRender(spec_, unit);
  EXPECT_TRUE(CheckPartial(good, unit, layout).ok());
  const std::vector<std::function<void(Partial&)>> damages = {
      [](Partial& p) { p.unit.piece = 1; },
      [](Partial& p) { p.pixels.x1 -= 1; },
      [](Partial& p) { p.layout.plain = 1; },
      [](Partial& p) { p.values.pop_back(); },
      [](Partial& p) { p.rays.clear(); },
      [](Partial& p) { p.nonfinite.push_back(0); },
      [](Partial& p) { p.samples[5] += 1; },
      [](Partial& p) { p.nonfinite[5] = 8 * 32 + 1; },
      [](Partial& p) { p.values[7] = std::nan(""); },
      [](Partial& p) { p.values[9] = INFINITY; },
      [](Partial& p) { p.values[static_cast<size_t>(p.layout.M2(1))] = -1; },
  };
  for (size_t i = 0; i < damages.size(); ++i) {
    Partial damaged = good;
    damages[i](damaged);
    EXPECT_FALSE(CheckPartial(damaged, unit, layout).ok()) << "damage " << i;
  }
}

}  // namespace
}  // namespace strata
