// Whether the errors the farm claims are the errors it makes: the same crop of a Cornell box under
// many seeds, merged into a film and estimated as a job's result is.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/estimate.h"
#include "coordinator/film.h"
#include "coordinator/next_round.h"
#include "coordinator/round_plan.h"
#include "worker/integrator/render.h"
#include "worker/scene/file_source.h"

namespace strata {
namespace {

constexpr int kSeeds = 200;
constexpr int kCrop = 32;

/// What many seeds say of one pixel and colour.
struct PixelTrials {
  double mean[kSeeds], error_squared[kSeeds], iid_error_squared[kSeeds], ci95[kSeeds];
};

std::vector<PixelEstimate> RenderAndEstimate(const Renderer& renderer, RenderPool& pool,
                                             const JobSpec& spec) {
  // The tests of this file may run at the same time.
  const char* test = testing::UnitTest::GetInstance()->current_test_info()->name();
  const auto path = std::filesystem::path(testing::TempDir()) / (std::string(test) + ".film");
  const TileGrid grid{spec.crop, spec.tile};
  auto film = Film::Create(path, {FilmLayer::kPath, grid, LayoutOf(spec)});
  EXPECT_TRUE(film.ok()) << film.status();
  const RoundPlan plan = PlanFirstRound(spec);
  for (uint32_t tile = 0; tile < grid.Count(); ++tile) {
    for (uint32_t piece = 0; piece < plan.Pieces(tile); ++piece) {
      auto partial = renderer.Render(*plan.Unit({0, tile, piece}), pool);
      EXPECT_TRUE(partial.ok()) << partial.status();
      (*film)->Merge(*partial, {0, piece + 1});
    }
  }
  return Estimate(GatherEstimateInput(**film, spec.crop));
}

/// kCrop x kCrop pixels x kColours, each with kSeeds trials.
std::vector<PixelTrials> Trials(const std::filesystem::path& folder, const std::string& file,
                                uint32_t spp) {
  const DirectorySource source(folder);
  auto scene = LoadScene(source, file);
  EXPECT_TRUE(scene.ok()) << scene.status();
  RenderPool pool(2);
  std::vector<PixelTrials> trials(size_t{kCrop} * kCrop * kColours);
  for (int seed = 0; seed < kSeeds; ++seed) {
    JobSpec spec;
    spec.bundle = {file, {{file, {}, 0}}};
    spec.width = spec.height = 128;
    spec.crop = {28, 64, 28 + kCrop, 64 + kCrop};  // A box, its shadow, the red wall.
    spec.max_depth = 65;
    spec.filter = DefaultFilter(FilterKind::kGaussian);
    spec.spp = spp;
    spec.seed = static_cast<uint64_t>(seed) + 1;
    auto renderer = Renderer::Create(*scene, spec);
    EXPECT_TRUE(renderer.ok()) << renderer.status();
    const std::vector<PixelEstimate> pixels = RenderAndEstimate(**renderer, pool, spec);
    for (size_t p = 0; p < pixels.size(); ++p) {
      for (int c = 0; c < kColours; ++c) {
        PixelTrials& t = trials[p * kColours + static_cast<size_t>(c)];
        const PixelEstimate& e = pixels[p];
        t.mean[seed] = e.mean[c];
        t.error_squared[seed] = e.standard_error[c] * e.standard_error[c];
        t.iid_error_squared[seed] = e.variance[c] / static_cast<double>(e.samples);
        t.ci95[seed] = e.ci95[c];
      }
    }
  }
  return trials;
}

double Mean(const double (&values)[kSeeds]) {
  double sum = 0;
  for (const double v : values) sum += v;
  return sum / kSeeds;
}

/// Of the estimates over seeds, about their mean.
double Variance(const PixelTrials& t) {
  const double mean = Mean(t.mean);
  double sum = 0;
  for (const double v : t.mean) sum += (v - mean) * (v - mean);
  return sum / (kSeeds - 1);
}

/// Pixels whose colours all vary over seeds.
int LivePixels(const std::vector<PixelTrials>& trials) {
  int live = 0;
  for (size_t first = 0; first < trials.size(); first += kColours)
    live += std::all_of(&trials[first], &trials[first] + kColours,
                        [](const PixelTrials& t) { return Variance(t) > 0; });
  return live;
}

/// The mean over pixels and colours of mean(SE^2) / variance, times (S-3)/(S-1): the mean of the
/// reciprocal of a chi-square variable of S-1 degrees of freedom is 1/(S-3). Those without variance
/// are left out.
double ErrorRatio(const std::vector<PixelTrials>& trials,
                  const double (PixelTrials::*error_squared)[kSeeds]) {
  double sum = 0;
  int live = 0;
  for (const PixelTrials& t : trials) {
    const double variance = Variance(t);
    if (variance == 0) continue;
    sum += Mean(t.*error_squared) / variance;
    ++live;
  }
  return sum / live * (kSeeds - 3) / (kSeeds - 1);
}

/// The share of intervals that hold the mean over all seeds, whose own variance is 1/200 of theirs.
double Coverage(const std::vector<PixelTrials>& trials) {
  int64_t held = 0, all = 0;
  for (const PixelTrials& t : trials) {
    if (Variance(t) == 0) continue;
    const double mean = Mean(t.mean);
    for (int s = 0; s < kSeeds; ++s, ++all) held += std::abs(t.mean[s] - mean) <= t.ci95[s];
  }
  return static_cast<double>(held) / static_cast<double>(all);
}

/// The mean over 3072 pixel-channels of ratios that scatter by about 0.14 each is known to about
/// 0.004 (colours of a pixel are correlated), so that 0.03 is some seven standard errors.
void ExpectCalibrated(const std::vector<PixelTrials>& trials) {
  EXPECT_GE(LivePixels(trials), 32 * 32);
  const double ratio = ErrorRatio(trials, &PixelTrials::error_squared);
  const double iid_ratio = ErrorRatio(trials, &PixelTrials::iid_error_squared);
  const double coverage = Coverage(trials);
  std::printf("mean(SE^2)/variance %.4f, with s^2/n instead %.4f, coverage of ci95 %.4f\n", ratio,
              iid_ratio, coverage);
  EXPECT_GT(ratio, 0.97);
  EXPECT_LT(ratio, 1.03);
  // The control: per-sample s^2/n is not the variance of a stratified mean.
  EXPECT_GT(iid_ratio, 1.03);
  // Intervals so short a render can promise; docs/accuracy of 256 spp is a matter of its own.
  EXPECT_GT(coverage, 0.93);
  EXPECT_LT(coverage, 0.97);
}

TEST(StandardErrors, MatchTheSpreadOverSeedsOnTheSharedCornellBox) {
  const char* shared = std::getenv("STRATA_SHARED");
  const std::filesystem::path root = shared ? shared : STRATA_SOURCE_DIR "/../shared";
  const auto folder = root / "scenes/pbrt/cornell-box";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no shared scenes at " << root;
  ExpectCalibrated(Trials(folder, "scene.pbrt", 64));
}

TEST(StandardErrors, MatchTheSpreadOverSeedsOnTheProjectsCornellBox) {
  ExpectCalibrated(Trials(STRATA_SOURCE_DIR "/scenes/cornell-box", "cornell-box.pbrt", 64));
}

}  // namespace
}  // namespace strata
