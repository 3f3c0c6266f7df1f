// Estimates, intervals and flags against their definitions, computed the long way.

#include "coordinator/estimate.h"
#include "coordinator/next_round.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <random>

#include "coordinator/film_summary.h"
#include "coordinator/image.h"
#include "coordinator/ordered_merge.h"
#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

/// Skewed samples: mostly dark, sometimes bright; more so to the right.
double SkewedSample(const JobSpec& spec, int x, int y, int replicate, uint32_t index, int channel) {
  const double u = FakeUniform(spec.seed, x, y, replicate, index, channel);
  return u < 0.5 / (1 + 0.6 * x) ? 1.0 + x : 0.05 * u;
}

class EstimateTest : public ::testing::Test {
 protected:
  EstimateTest() {
    spec_.width = 30;
    spec_.height = 20;
    spec_.crop = {2, 1, 29, 19};
    spec_.tile = 8;
    spec_.spp = 64;
  }
  void Render() {
    plan_ = std::make_shared<const RoundPlan>(PlanFirstRound(spec_));
    film_ =
        *Film::Create(directory_.path() / "film", {FilmLayer::kPath, plan_->grid, LayoutOf(spec_)});
    OrderedMerge merge(*film_, plan_);
    for (uint32_t t = 0; t < plan_->grid.Count(); ++t) {
      for (uint32_t k = 0; k < plan_->Pieces(t); ++k) {
        merge.Add(FakeRender(spec_, *plan_->Unit({0, t, k}), SkewedSample), 1);
      }
    }
  }
  /// All estimates, row-major over the crop.
  std::vector<PixelEstimate> Whole() const {
    return Estimate(GatherEstimateInput(*film_, spec_.crop));
  }
  const PixelEstimate& At(const std::vector<PixelEstimate>& whole, int x, int y) const {
    return whole[static_cast<size_t>((y - spec_.crop.y0) * spec_.crop.Width() + x - spec_.crop.x0)];
  }
  bool Inside(int x, int y) const {
    return x >= spec_.crop.x0 && x < spec_.crop.x1 && y >= spec_.crop.y0 && y < spec_.crop.y1;
  }
  std::vector<double> AllSamples(int x, int y, int channel, int replicate) const {
    std::vector<double> samples;
    for (uint32_t i = 0; i < spec_.spp / kReplicates; ++i) {
      samples.push_back(SkewedSample(spec_, x, y, replicate, i, channel));
    }
    return samples;
  }

  TestDirectory directory_;
  JobSpec spec_;
  std::shared_ptr<const RoundPlan> plan_;
  std::unique_ptr<Film> film_;
};

/// A pixel's figures the long way, from its samples.
struct BruteForce {
  double mean = 0, error_squared = 0, m2 = 0, m3 = 0;
};

BruteForce FromSamples(const std::vector<std::vector<double>>& replicates) {
  BruteForce result;
  std::vector<double> means, all;
  for (const std::vector<double>& replicate : replicates) {
    double sum = 0;
    for (const double x : replicate) sum += x;
    means.push_back(sum / static_cast<double>(replicate.size()));
    all.insert(all.end(), replicate.begin(), replicate.end());
  }
  for (const double m : means) result.mean += m / 8;
  for (const double m : means) result.error_squared += std::pow(m - result.mean, 2) / 7 / 8;
  for (const double x : all) {
    result.m2 += std::pow(x - result.mean, 2);
    result.m3 += std::pow(x - result.mean, 3);
  }
  return result;
}

TEST_F(EstimateTest, FollowsTheDefinitions) {
  Render();
  const auto brute = [&](int x, int y, int c) {
    std::vector<std::vector<double>> replicates;
    for (int r = 0; r < kReplicates; ++r) replicates.push_back(AllSamples(x, y, c, r));
    return FromSamples(replicates);
  };
  const std::vector<PixelEstimate> whole = Whole();
  const double n = spec_.spp;
  int flagged = 0, pixels = 0;
  for (int y = spec_.crop.y0; y < spec_.crop.y1; ++y) {
    for (int x = spec_.crop.x0; x < spec_.crop.x1; ++x, ++pixels) {
      const PixelEstimate& estimate = At(whole, x, y);
      EXPECT_EQ(estimate.samples, spec_.spp);
      bool skewed = false;
      for (int c = 0; c < kColours; ++c) {
        const BruteForce own = brute(x, y, c);
        EXPECT_NEAR(estimate.mean[c], own.mean, 1e-13);
        EXPECT_NEAR(estimate.standard_error[c], std::sqrt(own.error_squared), 1e-13);
        EXPECT_NEAR(estimate.variance[c], own.m2 / (n - 1), 1e-12);
        double beside = 0, neighbours = 0, m2 = 0, m3 = 0, ring = 0;
        for (int v = y - 2; v <= y + 2; ++v) {
          for (int u = x - 2; u <= x + 2; ++u) {
            if (!Inside(u, v)) continue;
            const BruteForce other = brute(u, v, c);
            if (u == x && v == y) continue;
            if (std::abs(u - x) <= 1 && std::abs(v - y) <= 1) {
              beside += n * other.error_squared;
              ++neighbours;
            }
            m2 += other.m2;
            m3 += other.m3;
            ring += n;
          }
        }
        const double v = 0.5 * n * own.error_squared + 0.5 * beside / neighbours;
        EXPECT_NEAR(estimate.ci95[c], kStudent25 * std::sqrt(v / n), 1e-12);
        const double skewness = (m3 / ring) / std::pow(m2 / ring, 1.5);
        skewed |= std::abs(skewness) > kMostSkewness * std::sqrt(n);
      }
      EXPECT_EQ((estimate.flags & kFlagSkew) != 0, skewed) << x << "," << y;
      flagged += skewed;
    }
  }
  EXPECT_GT(flagged, pixels / 10) << "the picture must have both kinds";
  EXPECT_LT(flagged, pixels * 9 / 10);
}

TEST_F(EstimateTest, DoesNotDependOnHowTheCropIsCut) {
  Render();
  const std::vector<PixelEstimate> whole = Whole();
  for (int y = spec_.crop.y0; y < spec_.crop.y1; y += 7) {
    for (int x = spec_.crop.x0; x < spec_.crop.x1; x += 5) {
      const PixelRect rect = {x, y, std::min(x + 5, spec_.crop.x1), std::min(y + 7, spec_.crop.y1)};
      const auto part = Estimate(GatherEstimateInput(*film_, rect));
      for (int v = rect.y0, i = 0; v < rect.y1; ++v) {
        for (int u = rect.x0; u < rect.x1; ++u, ++i) {
          for (int c = 0; c < kColours; ++c) {
            EXPECT_EQ(part[static_cast<size_t>(i)].ci95[c], At(whole, u, v).ci95[c]);
          }
          EXPECT_EQ(part[static_cast<size_t>(i)].flags, At(whole, u, v).flags);
        }
      }
    }
  }
}

TEST_F(EstimateTest, ThePixelsOwnSamplesDoNotDecideItsSkewFlag) {
  Render();
  const uint32_t before = At(Whole(), 4, 10).flags;
  ASSERT_EQ(before, 0u);
  const PixelLayout layout = LayoutOf(spec_);
  double* values = const_cast<double*>(film_->At(4, 10).values);
  values[layout.M3(0)] = 1e200;  // Would drown the others in any sum.
  EXPECT_EQ(At(Whole(), 4, 10).flags, before);
  EXPECT_NE(At(Whole(), 5, 10).flags & kFlagSkew, 0u) << "but its neighbours'";
}

TEST_F(EstimateTest, ClaimsNoIntervalWhereASampleWasNotFinite) {
  Render();
  const_cast<PixelCounts&>(*film_->At(5, 5).counts).nonfinite = 1;
  const std::vector<PixelEstimate> whole = Whole();
  EXPECT_EQ(At(whole, 5, 5).ci95[0], std::numeric_limits<double>::infinity());
  EXPECT_NE(At(whole, 5, 5).flags & kFlagNonFinite, 0u);
  EXPECT_EQ(At(whole, 6, 5).flags & kFlagNonFinite, 0u);
}

TEST(StudentQuantile, IsThatOfTheDegreesOfFreedom) {
  const boost::math::students_t_distribution<double> student(kIntervalDegrees);
  EXPECT_NEAR(kStudent25, boost::math::quantile(student, 0.975), 1e-12);
  const boost::math::students_t_distribution<double> alone(kReplicates - 1);
  EXPECT_NEAR(kStudent7, boost::math::quantile(alone, 0.975), 1e-12);
}

// ---- coverage ----

/// The share of intervals that hold the true mean 1, over pixels whose samples are normal.
double Coverage(bool pooled) {
  constexpr int kEdge = 128;
  constexpr uint32_t kSamples = 16;  // Of each replicate.
  const TestDirectory directory;
  JobSpec spec;
  spec.width = spec.height = kEdge;
  spec.crop = {0, 0, kEdge, kEdge};
  spec.tile = kEdge;
  spec.spp = kReplicates * kSamples;
  const RoundPlan plan = PlanFirstRound(spec);
  Partial partial = FakeRender(spec, *plan.Unit({0, 0, 0}));
  std::mt19937_64 random(20240611);
  std::normal_distribution<double> mean_of_replicate(1, 0.5 / std::sqrt(kSamples));
  const PixelLayout layout = LayoutOf(spec);
  for (size_t i = 0; i < partial.samples.size(); ++i) {
    double* values = &partial.values[i * static_cast<size_t>(layout.Doubles())];
    for (int k = 0; k < kReplicates * layout.estimated; ++k) values[k] = mean_of_replicate(random);
  }
  const auto film = *Film::Create(directory.path() / "film", {FilmLayer::kPath, plan.grid, layout});
  film->Merge(partial, {0, 1});
  int covered = 0, intervals = 0;
  for (const PixelEstimate& estimate : Estimate(GatherEstimateInput(*film, spec.crop))) {
    for (int c = 0; c < kColours; ++c, ++intervals) {
      const double half_width = pooled ? estimate.ci95[c] : 1.96 * estimate.standard_error[c];
      covered += std::fabs(estimate.mean[c] - 1) <= half_width;
    }
  }
  return static_cast<double>(covered) / intervals;
}

// 0.95 is due, give or take Satterthwaite's approximation; 49152 intervals have a standard error of
// 0.001, and the bounds are 5 of them away from 0.951.
TEST(CoverageTest, Ci95CoversNormalPixels) { EXPECT_NEAR(Coverage(true), 0.951, 0.005); }

// The control: a normal quantile with one pixel's 7 degrees of freedom covers 0.909.
TEST(CoverageTest, RawNormalIntervalsDoNot) { EXPECT_LT(Coverage(false), 0.951 - 0.005); }

// ---- the summary ----

TEST_F(EstimateTest, SummaryFollowsItsDefinition) {
  Render();
  const std::vector<PixelEstimate> whole = Whole();
  SummaryInput input(plan_->grid);
  for (uint32_t t = 0; t < plan_->grid.Count(); ++t) {
    input.Update(t, Estimate(GatherEstimateInput(*film_, plan_->grid.Rect(t))));
  }
  const FilmSummary summary = input.Summarize(1);
  EXPECT_EQ(input.Summarize(1.5).rel_error, 1.5 * summary.rel_error);
  double mean[3] = {}, flagged = 0;
  for (const PixelEstimate& e : whole) {
    for (int c = 0; c < 3; ++c) mean[c] += e.mean[c] / static_cast<double>(whole.size());
    flagged += e.flags != 0;
  }
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(summary.mean_rgb[c], mean[c], 1e-6);
  EXPECT_EQ(summary.flagged, flagged / static_cast<double>(whole.size()));
  const auto luminance = [](const double* rgb) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
  };
  std::vector<double> errors;
  for (const PixelEstimate& e : whole) {
    for (const double h : e.ci95) {
      errors.push_back(h / std::max(luminance(e.mean), 0.05 * luminance(mean)));
    }
  }
  std::sort(errors.begin(), errors.end());
  const size_t rank = static_cast<size_t>(std::ceil(0.99 * static_cast<double>(errors.size())));
  EXPECT_NEAR(summary.rel_error, errors[rank - 1], 1e-5 * summary.rel_error);
  ASSERT_EQ(summary.worst_tiles.size(), 5u);
  EXPECT_GE(summary.worst_tiles[0].rel_error, summary.worst_tiles[4].rel_error);
  EXPECT_GE(summary.worst_tiles[0].rel_error, summary.rel_error);
}

TEST_F(EstimateTest, WhereTheSamplerClaimsNoneThereIsNoInterval) {
  Render();
  const std::vector<PixelEstimate> claimed = Whole();
  const std::vector<PixelEstimate> none =
      Estimate(GatherEstimateInput(*film_, spec_.crop, SamplerKind::kHaltonPlain));
  for (size_t i = 0; i < none.size(); ++i) {
    EXPECT_EQ(none[i].mean[1], claimed[i].mean[1]);
    EXPECT_EQ(none[i].ci95[1], std::numeric_limits<double>::infinity());
    EXPECT_EQ(none[i].flags, claimed[i].flags | kFlagNoInterval);
  }
}

TEST_F(EstimateTest, SummaryHasNoErrorUntilEveryPixelHasSamples) {
  Render();
  SummaryInput input(plan_->grid);
  for (uint32_t t = 1; t < plan_->grid.Count(); ++t) {
    input.Update(t, Estimate(GatherEstimateInput(*film_, plan_->grid.Rect(t))));
  }
  EXPECT_EQ(input.Summarize(1).rel_error, 0);
}

TEST_F(EstimateTest, ImageHasTheLayersInOrder) {
  spec_.channels = {true, false, false, true};
  Render();
  ImageBuilder builder(spec_, 1.5);
  builder.Fill(GatherEstimateInput(*film_, spec_.crop), GatherPlain(*film_, spec_.crop));
  const ImageLayers image = builder.Finish({});
  const std::vector<std::string> expected = {"R",          "G",          "B",         "A",
                                             "depth.Z",    "stderr.R",   "stderr.G",  "stderr.B",
                                             "ci95.R",     "ci95.G",     "ci95.B",    "variance.R",
                                             "variance.G", "variance.B", "samples.Y", "flags.Y"};
  EXPECT_EQ(image.channels, expected);
  const PixelEstimate estimate = At(Whole(), 12, 7);
  const size_t pixel = static_cast<size_t>((7 - 1) * spec_.crop.Width() + (12 - 2));
  const float* values = &image.values[pixel * expected.size()];
  EXPECT_EQ(values[1], static_cast<float>(estimate.mean[1]));
  EXPECT_EQ(values[4], static_cast<float>(film_->At(12, 7).values[LayoutOf(spec_).Plain(1)]));
  EXPECT_EQ(values[7], static_cast<float>(estimate.standard_error[2]));
  EXPECT_EQ(values[8], static_cast<float>(1.5 * estimate.ci95[0]));
  EXPECT_EQ(values[11], static_cast<float>(estimate.variance[0]));
  EXPECT_EQ(values[14], 64);
}

}  // namespace
}  // namespace strata
