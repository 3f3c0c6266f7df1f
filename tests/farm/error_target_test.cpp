// Targets: what decides a pixel's samples, whether the target is then met, and at what price.

#include "coordinator/error_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <tuple>
#include <utility>

#include "coordinator/allocation.h"
#include "tests/farm/synthetic_image.h"

namespace strata {
namespace {

constexpr uint32_t kCap = 1 << 16;

using Plan = TargetRound (*)(const PixelStatistics&, double, uint32_t);

/// Rare bright samples of many heights over noise of many levels.
SyntheticImage SkewedImage(size_t edge) {
  return SyntheticImage({edge, edge}, [edge](size_t x, size_t y) {
    const double u = static_cast<double>(x) / static_cast<double>(edge);
    const double v = static_cast<double>(y) / static_cast<double>(edge);
    SyntheticPixel pixel{0.1 + 0.4 * u, 0, 0, 0.05 + 0.3 * u * v};
    if (v > 0.6) pixel.bright = 1 + 4 * u;
    if (v > 0.6) pixel.probability = 0.05;
    return pixel;
  });
}

struct Finished {
  int rounds = 0;
  double average = 0;  ///< Samples of a pixel, over all replicates.
  TargetRound last;
};

/// The pilot of 64, and rounds to the end.
Finished RenderTo(SyntheticRender& render, Plan plan, double target, uint32_t cap = kCap) {
  Finished finished;
  render.RenderTo(8);
  finished.last = plan(render.Statistics(), target, cap);
  while (finished.last.added > 0 && finished.rounds < 50) {
    ++finished.rounds;
    render.RenderTo(finished.last.ends);
    finished.last = plan(render.Statistics(), target, cap);
  }
  finished.average = render.AverageSamples();
  return finished;
}

double MeanLuminance(const SyntheticImage& image) {
  double sum = 0;
  for (const SyntheticPixel& pixel : image.pixels()) sum += pixel.Mean();
  return sum / static_cast<double>(image.pixels().size());
}

/// The samples that each pixel needs if all is known.
std::vector<double> TrueNeeds(const SyntheticImage& image, double error) {
  const double least = 0.05 * MeanLuminance(image);
  std::vector<double> needs;
  for (const SyntheticPixel& pixel : image.pixels()) {
    const double widest = error * std::max(pixel.Mean(), least) / kStudent50;
    needs.push_back(pixel.Variance() / (widest * widest));
  }
  return needs;
}

double RoundUp(double samples) { return std::max(8.0, 8 * std::ceil(samples / 8)); }

/// What one would spend who knows the variances and leaves out the hundredth that needs most.
double OracleForRelativeError(const SyntheticImage& image, double error) {
  std::vector<double> needs = TrueNeeds(image, error);
  std::sort(needs.begin(), needs.end());
  double sum = 0;
  for (size_t i = 0; i < needs.size(); ++i) {
    sum += i < needs.size() - needs.size() / 100 ? RoundUp(needs[i]) : 8;
  }
  return sum / static_cast<double>(needs.size());
}

/// Neyman's allocation from true variances.
double OracleForRmse(const SyntheticImage& image, double rmse) {
  double deviation = 0;
  for (const SyntheticPixel& pixel : image.pixels()) deviation += std::sqrt(pixel.Variance());
  const double pixels = static_cast<double>(image.pixels().size());
  double sum = 0;
  for (const SyntheticPixel& pixel : image.pixels()) {
    sum += RoundUp(std::sqrt(pixel.Variance()) * deviation / (pixels * rmse * rmse));
  }
  return sum / pixels;
}

TEST(ErrorTargetTest, MeetsARelativeErrorForLessThanTwiceTheLeast) {
  const SyntheticImage image = SkewedImage(96);
  for (const double error : {0.2, 0.1, 0.05}) {
    double average = 0, met = 0, rounds = 0;
    constexpr int kSeeds = 5;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      SyntheticRender render(image, seed);
      const Finished finished = RenderTo(render, &PlanForRelativeError, error);
      EXPECT_TRUE(finished.last.met);
      EXPECT_GE(finished.last.met_share, 0.99);
      EXPECT_LE(finished.last.error, error);
      EXPECT_LE(finished.rounds, 6);
      average += finished.average / kSeeds;
      rounds += finished.rounds * 1.0 / kSeeds;
      const std::vector<double> needs = TrueNeeds(image, error);
      double truly = 0;
      for (size_t i = 0; i < needs.size(); ++i) truly += 8 * render.Samples(i) >= needs[i];
      met += truly / static_cast<double>(needs.size()) / kSeeds;
    }
    const double oracle = OracleForRelativeError(image, error);
    std::printf("error %.2f: %.0f samples, oracle %.0f, ratio %.3f; %.1f rounds; truly met %.4f\n",
                error, average, oracle, average / oracle, rounds, met);
    EXPECT_LT(average, 2 * oracle);
    EXPECT_GT(met, 0.97);
  }
}

TEST(ErrorTargetTest, MeetsAnRmseForLessThanTwiceTheLeast) {
  const SyntheticImage image = SkewedImage(96);
  for (const double rmse : {0.03, 0.02, 0.01}) {
    double average = 0, truth = 0, rounds = 0;
    constexpr int kSeeds = 5;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      SyntheticRender render(image, seed);
      const Finished finished = RenderTo(render, &PlanForRmse, rmse);
      EXPECT_TRUE(finished.last.met);
      EXPECT_LE(finished.last.error, rmse);
      EXPECT_LE(finished.rounds, 6);
      average += finished.average / kSeeds;
      rounds += finished.rounds * 1.0 / kSeeds;
      double squares = 0;
      for (size_t i = 0; i < image.pixels().size(); ++i) {
        squares += image.pixels()[i].Variance() / (8 * render.Samples(i));
      }
      truth += std::sqrt(squares / static_cast<double>(image.pixels().size())) / kSeeds;
    }
    const double oracle = OracleForRmse(image, rmse);
    std::printf("rmse %.3f: %.0f samples, oracle %.0f, ratio %.3f; %.1f rounds; true rmse %.4f\n",
                rmse, average, oracle, average / oracle, rounds, truth);
    EXPECT_LT(average, 2 * oracle);
    EXPECT_NEAR(truth, rmse, 0.05 * rmse);
  }
}

TEST(ErrorTargetTest, PredictsWhatWillBeNeeded) {
  const SyntheticImage image = SkewedImage(64);
  for (const auto& [plan, target] : {std::pair<Plan, double>{&PlanForRelativeError, 0.05},
                                     std::pair<Plan, double>{&PlanForRmse, 0.01}}) {
    std::vector<double> added;
    double claimed = 0;
    constexpr int kSeeds = 60;
    for (uint64_t seed = 0; seed < kSeeds; ++seed) {
      SyntheticRender render(image, seed);
      render.RenderTo(8);
      const TargetRound round = plan(render.Statistics(), target, kCap);
      added.push_back(static_cast<double>(round.added));
      claimed += round.added_deviation / kSeeds;
    }
    double mean = 0, squares = 0;
    for (const double a : added) mean += a / kSeeds;
    for (const double a : added) squares += (a - mean) * (a - mean) / (kSeeds - 1);
    std::printf("added %.0f, claimed deviation %.4f, seen %.4f of it\n", mean, claimed / mean,
                std::sqrt(squares) / mean);
    EXPECT_GT(claimed, 0.5 * std::sqrt(squares));
    EXPECT_LT(claimed, 2 * std::sqrt(squares));
  }
}

// ---- what decides ----

class EitherTarget : public ::testing::TestWithParam<std::pair<Plan, double>> {
 protected:
  TargetRound Next(const PixelStatistics& now, uint32_t cap = kCap) const {
    return GetParam().first(now, GetParam().second, cap);
  }
};
INSTANTIATE_TEST_SUITE_P(Targets, EitherTarget,
                         ::testing::Values(std::pair<Plan, double>{&PlanForRelativeError, 0.1},
                                           std::pair<Plan, double>{&PlanForRmse, 0.02}));

TEST_P(EitherTarget, APixelsOwnStatisticsDoNotMoveItsSamples) {
  const SyntheticImage image = SkewedImage(40);
  SyntheticRender render(image, 4);
  render.RenderTo(8);
  // Also near the end, where most pixels have enough.
  for (int round = 0; round < 3; ++round) {
    const PixelStatistics now = render.Statistics();
    const TargetRound expected = Next(now);
    int others_moved = 0;
    for (const size_t i : {0, 1, 39, 200, 417, 800, 1000, 1203, 1560, 1562, 1599}) {
      for (const double size : {0.0, 1e-20, 1.0, 1e30}) {
        PixelStatistics changed = now;
        changed.luminance[i] = size;
        for (std::vector<double>& variance : changed.variance) variance[i] = size * size;
        changed.rays[i] = 1 + 50 * size;
        changed.nonfinite[i] = 1;
        const TargetRound moved = Next(changed);
        EXPECT_EQ(moved.ends[i], expected.ends[i]) << "pixel " << i << ", round " << round;
        others_moved += moved.ends != expected.ends;
      }
    }
    EXPECT_GT(others_moved, 0);
    render.RenderTo(expected.ends);
  }
}

TEST_P(EitherTarget, StopsAtTheCap) {
  const SyntheticImage image = SkewedImage(40);
  SyntheticRender render(image, 5);
  const Finished finished = RenderTo(render, GetParam().first, GetParam().second / 100, 128);
  EXPECT_FALSE(finished.last.met);
  EXPECT_EQ(finished.last.added, 0u);
  EXPECT_GT(finished.last.error, GetParam().second / 100);
  EXPECT_EQ(*std::max_element(finished.last.ends.begin(), finished.last.ends.end()), 16u);
}

TEST_P(EitherTarget, IsMetByABlackPicture) {
  const SyntheticImage image({40, 40}, [](size_t, size_t) { return SyntheticPixel{}; });
  SyntheticRender render(image, 6);
  const Finished finished = RenderTo(render, GetParam().first, GetParam().second);
  EXPECT_TRUE(finished.last.met);
  EXPECT_EQ(finished.rounds, 0);
  EXPECT_EQ(finished.last.error, 0);
  EXPECT_EQ(finished.last.met_share, 1);
}

TEST_P(EitherTarget, GivesCropsWithoutNeighboursTheCap) {
  const SyntheticImage image({5, 4}, [](size_t, size_t) { return SyntheticPixel{1, 0, 0, 1}; });
  SyntheticRender render(image, 7);
  render.RenderTo(8);
  const TargetRound round = Next(render.Statistics(), 1024);
  EXPECT_EQ(round.ends, std::vector<uint32_t>(20, 128));
  EXPECT_EQ(round.added, 20u * 8 * 120);
  EXPECT_FALSE(round.met);
}

TEST(ErrorTargetTest, DoesNotJudgePixelsWithSamplesThatWereNotFinite) {
  const SyntheticImage image = SkewedImage(40);
  SyntheticRender render(image, 8);
  render.RenderTo(8);
  PixelStatistics now = render.Statistics();
  const double all = PlanForRelativeError(now, 0.3, kCap).met_share;
  EXPECT_LT(all, 0.95);
  for (size_t i = 24 * 40; i < 1600; ++i) now.nonfinite[i] = 1;  // Where the bright samples are.
  EXPECT_GT(PlanForRelativeError(now, 0.3, kCap).met_share, all + 0.05);
}

// ---- bias ----

SyntheticImage Fireflies() {
  return SyntheticImage({32, 32}, [](size_t, size_t) { return SyntheticPixel{0.05, 2, 0.1, 0}; });
}

/// The control: each pixel goes on until its own interval is narrow enough.
TargetRound PlanByOwnPixel(const PixelStatistics& now, double error, uint32_t cap) {
  TargetRound round{now.samples};
  for (size_t i = 0; i < round.ends.size(); ++i) {
    const double widest = error * std::max(now.luminance[i], 0.01) / kStudent50;
    const double wanted = std::ceil(now.variance[0][i] / (widest * widest) / kReplicates);
    round.ends[i] = static_cast<uint32_t>(std::clamp<double>(wanted, round.ends[i], cap));
    round.added += kReplicates * uint64_t{round.ends[i] - now.samples[i]};
  }
  return round;
}

struct Bias {
  double mean = 0, error = 0;  ///< In standard errors.
  double rounds = 0;
};

Bias BiasOf(Plan plan, double target) {
  constexpr int kSeeds = 500;
  const SyntheticImage image = Fireflies();
  const SyntheticPixel& pixel = image.pixels()[0];
  std::vector<double> biases;
  Bias bias;
  for (uint64_t seed = 0; seed < kSeeds; ++seed) {
    SyntheticRender render(image, 7000 + seed);
    const Finished finished = RenderTo(render, plan, target);
    bias.rounds += finished.rounds * 1.0 / kSeeds;
    double sum = 0;
    for (size_t i = 0; i < image.pixels().size(); ++i) sum += render.Mean(i) - pixel.Mean();
    biases.push_back(sum / static_cast<double>(image.pixels().size()) /
                     std::sqrt(pixel.Variance() / finished.average));
  }
  for (const double b : biases) bias.mean += b / kSeeds;
  double squares = 0;
  for (const double b : biases) squares += (b - bias.mean) * (b - bias.mean);
  bias.error = std::sqrt(squares / (kSeeds - 1) / kSeeds);
  return bias;
}

// 3.3 standard errors of renders, which are independent: p = 0.001.
TEST(TargetBiasTest, LaterRoundsHaveNoneThatShows) {
  for (const auto& [name, plan, target] :
       {std::tuple<const char*, Plan, double>{"error", &PlanForRelativeError, 0.5},
        std::tuple<const char*, Plan, double>{"rmse", &PlanForRmse, 0.04}}) {
    const Bias bias = BiasOf(plan, target);
    std::printf("%s: %.4f +- %.4f standard errors, %.1f rounds\n", name, bias.mean, bias.error,
                bias.rounds);
    EXPECT_GT(bias.rounds, 1) << "there must be later rounds";
    EXPECT_LT(std::fabs(bias.mean), 3.3 * bias.error);
  }
}

TEST(TargetBiasTest, StoppingByOnesOwnIntervalHas) {
  const Bias bias = BiasOf(&PlanByOwnPixel, 0.4);
  std::printf("own interval: %.4f +- %.4f standard errors, %.1f rounds\n", bias.mean, bias.error,
              bias.rounds);
  EXPECT_GT(std::fabs(bias.mean), 10 * bias.error);
}

// The bound of error_target.h: E[N] sd(1/N) when the samples of one pixel alone are drawn anew.
TEST(TargetBiasTest, APixelsOwnSamplesHardlyMoveItsCount) {
  const SyntheticImage image = Fireflies();
  const auto bound = [&](Plan plan, double target) {
    constexpr int kPixels = 20, kRedraws = 20;
    double sum = 0;
    for (int k = 0; k < kPixels; ++k) {
      const size_t pixel = static_cast<size_t>(k) * 50;
      double count = 0, inverse = 0, squares = 0;
      for (uint64_t redraw = 0; redraw < kRedraws; ++redraw) {
        SyntheticRender render(image, 300 + static_cast<uint64_t>(k));
        render.Redraw(pixel, 9000 + redraw);
        RenderTo(render, plan, target);
        const double n = render.Samples(pixel);
        count += n / kRedraws;
        inverse += 1 / n / kRedraws;
        squares += 1 / (n * n) / kRedraws;
      }
      sum += count * std::sqrt(std::max(squares - inverse * inverse, 0.0)) / kPixels;
    }
    return sum;
  };
  const double error = bound(&PlanForRelativeError, 0.4), rmse = bound(&PlanForRmse, 0.04);
  const double own = bound(&PlanByOwnPixel, 0.4);
  std::printf("E[N] sd(1/N): error %.4f, rmse %.4f, own interval %.4f\n", error, rmse, own);
  EXPECT_LT(error, 0.05);
  EXPECT_LT(rmse, 0.05);
  EXPECT_GT(own, 0.1) << "the control must fail";
}

}  // namespace
}  // namespace strata
