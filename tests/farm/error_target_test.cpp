// Targets: what decides a pixel's samples, whether the target is then met, and at what price.

#include "coordinator/error_target.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>

#include "tests/farm/synthetic_job.h"

namespace strata {
namespace {

using enum TargetKind;

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
    const double widest = error * std::max(pixel.Mean(), least) / kStudent25;
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

/// Means over the seeds of an image size, which are fewer the larger it is.
struct Price {
  double average = 0, rounds = 0;
  double truth = 0;  ///< Share that truly meets `--error`; true rmse over the one wanted.
  double oracle = 0;
  double Ratio() const { return average / oracle; }
};

double Truth(const SyntheticImage& image, const SyntheticRender& render, const JobSpec& spec) {
  const double pixels = static_cast<double>(image.pixels().size());
  double sum = 0;
  if (spec.target == kRelativeError) {
    const std::vector<double> needs = TrueNeeds(image, spec.target_value);
    for (size_t i = 0; i < needs.size(); ++i) sum += 8 * render.Samples(i) >= needs[i];
    return sum / pixels;
  }
  for (size_t i = 0; i < image.pixels().size(); ++i) {
    sum += image.pixels()[i].Variance() / (8 * render.Samples(i));
  }
  return std::sqrt(sum / pixels) / spec.target_value;
}

Price PriceOf(const SyntheticImage& image, TargetKind target, double value) {
  const size_t pixels = image.pixels().size();
  const int seeds = SeedsOr(static_cast<int>(std::max<size_t>(2, 20000 / pixels)));
  const JobSpec spec = SyntheticSpec(image.size(), target, value);
  Price price;
  price.oracle =
      target == kRelativeError ? OracleForRelativeError(image, value) : OracleForRmse(image, value);
  for (int seed = 0; seed < seeds; ++seed) {
    SyntheticRender render(image, static_cast<uint64_t>(seed));
    const Finished finished = RenderJob(render, spec);
    EXPECT_TRUE(finished.last.target_met);
    EXPECT_GE(finished.last.target_share, 0.99);
    EXPECT_LE(finished.rounds, 8);
    price.average += finished.average / seeds;
    price.rounds += finished.rounds * 1.0 / seeds;
    price.truth += Truth(image, render, spec) / seeds;
  }
  return price;
}

constexpr std::pair<const char*, SyntheticImage (*)(size_t)> kImages[] = {
    {"skewed", &SkewedImage}, {"uneven", &UnevenImage}, {"lamp", &LampImage}, {"rare", &RareImage}};
constexpr size_t kEdges[] = {64, 128, 192};

// The rows of the tables in docs/accuracy.md, "Targets".
TEST(TargetPriceTest, ARelativeErrorIsMetForLessThanTwiceTheLeast) {
  for (const auto& [name, image_of] : kImages) {
    for (const double error : {0.4, 0.2, 0.1, 0.05}) {
      std::string ratios, met;
      Price largest;
      for (const size_t edge : kEdges) {
        const Price price = largest = PriceOf(image_of(edge), kRelativeError, error);
        char text[20];
        std::snprintf(text, sizeof(text), " %.2f |", price.Ratio());
        ratios += text;
        std::snprintf(text, sizeof(text), " %.1f |", 100 * price.truth);
        met += text;
        // Below 32 samples the pilot alone may be more than twice the least.
        if (price.oracle > 32) {
          EXPECT_LT(price.Ratio(), 2) << name << ' ' << error << ' ' << edge;
        }
        // Where samples are few and rare ones matter, variances are found too small.
        if (std::string(name) != "rare" && error < 0.4) {
          EXPECT_GT(price.truth, 0.985);
        }
      }
      std::printf("| %s | %g %% | %.0f | %.0f |%s%s %.1f |\n", name, 100 * error, largest.oracle,
                  largest.average, ratios.c_str(), met.c_str(), largest.rounds);
    }
  }
}

TEST(TargetPriceTest, AnRmseIsMetForLessThanTwiceTheLeast) {
  for (const auto& [name, image_of] : kImages) {
    for (const double samples : {50.0, 200.0, 1000.0}) {
      std::string ratios, truths;
      Price largest;
      double rmse = 0;
      for (const size_t edge : kEdges) {
        const SyntheticImage image = image_of(edge);
        rmse = std::sqrt(OracleForRmse(image, 0.001) / samples) * 0.001;
        const Price price = largest = PriceOf(image, kRmse, rmse);
        char text[20];
        std::snprintf(text, sizeof(text), " %.2f |", price.Ratio());
        ratios += text;
        std::snprintf(text, sizeof(text), " %.3f |", price.truth);
        truths += text;
        EXPECT_LT(price.Ratio(), 2) << name << ' ' << samples << ' ' << edge;
        if (std::string(name) != "rare") {
          EXPECT_NEAR(price.truth, 1, 0.05);
        }
      }
      std::printf("| %s | %.4f | %.0f | %.0f |%s%s %.1f |\n", name, rmse, largest.oracle,
                  largest.average, ratios.c_str(), truths.c_str(), largest.rounds);
    }
  }
}

TEST(TargetPriceTest, IsPredicted) {
  const SyntheticImage image = SkewedImage(64);
  for (const AllocationKind allocation : {AllocationKind::kRing, AllocationKind::kUniform}) {
    for (const auto& [target, value] : {std::pair{kRelativeError, 0.05}, {kRmse, 0.01}}) {
      const JobSpec spec = SyntheticSpec(image.size(), target, value, allocation);
      constexpr int kSeeds = 60;
      double sum = 0, squares = 0, claimed = 0;
      for (uint64_t seed = 0; seed < kSeeds; ++seed) {
        SyntheticRender render(image, seed);
        render.RenderTo(8);
        const NextRound next = PlanNextRound(spec, 1, render.Statistics());
        sum += next.samples_left;
        squares += next.samples_left * next.samples_left;
        claimed += next.deviation / kSeeds;
      }
      const double mean = sum / kSeeds;
      const double seen = std::sqrt((squares - sum * mean) / (kSeeds - 1));
      std::printf("%.0f samples left, claimed deviation %.4f, seen %.4f of it\n", mean,
                  claimed / mean, seen / mean);
      EXPECT_GT(claimed, 0.5 * seen);
      EXPECT_LT(claimed, 2 * seen);
    }
  }
}

// ---- what decides ----

class EitherTarget : public ::testing::TestWithParam<std::pair<TargetKind, double>> {
 protected:
  JobSpec Spec(PlaneSize size, double times = 1, uint32_t cap = 1 << 16) const {
    return SyntheticSpec(size, GetParam().first, GetParam().second * times, AllocationKind::kRing,
                         cap);
  }
};
INSTANTIATE_TEST_SUITE_P(Targets, EitherTarget,
                         ::testing::Values(std::pair{kRelativeError, 0.1}, std::pair{kRmse, 0.02}));

/// What pixel i's statistics may be, from none to absurd.
PixelStatistics WithPixel(PixelStatistics now, size_t i, double size) {
  now.luminance[i] = size;
  for (Plane& variance : now.variance) variance[i] = size * size;
  now.rays[i] = 1 + 50 * size;
  now.nonfinite[i] = 1;
  return now;
}

/// Renders a job; at each round's end, the last one included, asks of some pixels whether their
/// own statistics move the plan for them, and calls told(own moved, others moved, met moved).
template <typename Told>
void PerturbPixels(const JobSpec& spec, size_t edge, Told told) {
  const SyntheticImage image = SkewedImage(edge);
  SyntheticRender render(image, 4);
  render.RenderTo(PlanFirstRound(spec).classes[0].range.end);
  for (uint32_t finished = 1;; ++finished) {
    const PixelStatistics now = render.Statistics();
    const NextRound next = PlanNextRound(spec, finished, now);
    const std::vector<uint32_t> ends = EndsOf(next.plan, now);
    for (size_t i = 0; i < ends.size(); i += i < edge ? edge / 2 - 1 : 173) {
      for (const double size : {0.0, 1e-20, 1.0, 1e30}) {
        const NextRound moved = PlanNextRound(spec, finished, WithPixel(now, i, size));
        told(EndOf(moved.plan, now, i) != ends[i], EndsOf(moved.plan, now) != ends,
             moved.target_met != next.target_met);
      }
    }
    if (!next.plan) break;
    render.RenderTo(ends);
  }
}

TEST(ErrorTargetTest, APixelsOwnStatisticsDoNotMoveItsSamples) {
  for (const auto& [target, value] :
       {std::pair{kRelativeError, 0.1}, {kRmse, 0.02}, {kSamples, 0.0}}) {
    for (const size_t edge : {40, 72}) {
      const uint32_t spp = target == kSamples ? 256 : 1 << 16;
      int others_moved = 0, met_moved = 0;
      PerturbPixels(SyntheticSpec({edge, edge}, target, value, AllocationKind::kRing, spp), edge,
                    [&](bool own, bool others, bool met) {
                      EXPECT_FALSE(own);
                      others_moved += others;
                      met_moved += met;
                    });
      EXPECT_GT(others_moved, 0) << "they do move those of others";
      // What is said of the whole image decides nothing.
      if (target == kRmse) {
        EXPECT_GT(met_moved, 0);
      }
    }
  }
}

TEST(ErrorTargetTest, WithUniformAllocationTheyDo) {
  for (const auto& [target, value] : {std::pair{kRelativeError, 0.1}, {kRmse, 0.02}}) {
    int own_moved = 0;
    PerturbPixels(SyntheticSpec({40, 40}, target, value, AllocationKind::kUniform), 40,
                  [&](bool own, bool, bool) { own_moved += own; });
    EXPECT_GT(own_moved, 0);
  }
}

TEST_P(EitherTarget, IsMetBelowTheCapWhereTheNoiseIsInOnePlace) {
  for (const size_t edge : {24, 32, 40, 64, 100}) {
    for (const auto& [width, height] : {std::pair<size_t, size_t>{4, 3}, {5, 5}, {8, 8}}) {
      const SyntheticImage image(
          {edge, edge}, [width = width, height = height](size_t x, size_t y) {
            const bool noisy = x >= 7 && x < 7 + width && y >= 9 && y < 9 + height;
            return SyntheticPixel{1, 0, 0, noisy ? 2.0 : 0.1};
          });
      SyntheticRender render(image, 9);
      const Finished finished = RenderJob(render, Spec({edge, edge}));
      EXPECT_TRUE(finished.last.target_met) << edge << ": " << width << 'x' << height;
      EXPECT_LE(finished.rounds, 12);
      EXPECT_LT(finished.average, 4000);
    }
  }
}

TEST_P(EitherTarget, StopsAtTheCap) {
  const SyntheticImage image = SkewedImage(40);
  SyntheticRender render(image, 5);
  const Finished finished = RenderJob(render, Spec({40, 40}, 0.01, 128));
  EXPECT_FALSE(finished.last.target_met);
  EXPECT_EQ(finished.average, 128);
}

TEST_P(EitherTarget, IsMetByABlackPicture) {
  const SyntheticImage image({40, 40}, [](size_t, size_t) { return SyntheticPixel{}; });
  SyntheticRender render(image, 6);
  const Finished finished = RenderJob(render, Spec({40, 40}));
  EXPECT_TRUE(finished.last.target_met);
  EXPECT_EQ(finished.rounds, 0);
  EXPECT_EQ(finished.last.target_share, 1);
}

TEST(ErrorTargetTest, GivesCropsWithoutNeighboursTheCap) {
  const SyntheticImage image({5, 4}, [](size_t, size_t) { return SyntheticPixel{1, 0, 0, 1}; });
  SyntheticRender render(image, 7);
  render.RenderTo(8);
  const PixelStatistics now = render.Statistics();
  for (const TargetRound& round :
       {PlanForRelativeError(now, 0.1, 1024), PlanForRmse(now, 0.02, 1024)}) {
    EXPECT_EQ(round.ends, std::vector<uint32_t>(20, 128));
    EXPECT_EQ(round.added, 20u * 8 * 120);
    EXPECT_FALSE(round.met);
  }
}

PixelStatistics AfterPilot(const SyntheticImage& image) {
  SyntheticRender render(image, 8);
  render.RenderTo(8);
  return render.Statistics();
}

TEST(ErrorTargetTest, DoesNotJudgePixelsWithSamplesThatWereNotFinite) {
  PixelStatistics now = AfterPilot(SkewedImage(40));
  const double all = PlanForRelativeError(now, 0.3, 1 << 16).met_share;
  EXPECT_LT(all, 0.95);
  for (size_t i = 24 * 40; i < 1600; ++i) now.nonfinite[i] = 1;  // Where the bright samples are.
  EXPECT_GT(PlanForRelativeError(now, 0.3, 1 << 16).met_share, all + 0.05);
}

TEST(ErrorTargetTest, JudgesAPixelByItselfWhereNoneAroundItShowsNoise) {
  PixelStatistics now =
      AfterPilot(SyntheticImage({40, 40}, [](size_t, size_t) { return SyntheticPixel{0.5}; }));
  EXPECT_EQ(PlanForRelativeError(now, 0.1, 1 << 16).met_share, 1);
  constexpr size_t kApart = 6;  // So that no ring holds another.
  size_t lone = 0;
  for (size_t i = 0; i < 1600; ++i) {
    if (i % 40 % kApart != 3 || i / 40 % kApart != 3) continue;
    now.variance[1][i] = 100;
    ++lone;
  }
  const TargetRound round = PlanForRelativeError(now, 0.1, 1 << 16);
  EXPECT_FALSE(round.met);
  EXPECT_EQ(round.ends[3 * 40 + 3], 8u) << "which decides nothing";
  EXPECT_GT(round.ends[3 * 40 + 4], 8u);
  EXPECT_LT(round.met_share, 1 - static_cast<double>(lone) / 1600 + 1e-9);
}

}  // namespace
}  // namespace strata
