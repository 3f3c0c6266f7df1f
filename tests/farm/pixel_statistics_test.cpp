// The snapshot that plans are made of says what the estimates say.

#include "coordinator/pixel_statistics.h"

#include <gtest/gtest.h>

#include "coordinator/ordered_merge.h"
#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

TEST(PixelStatisticsTest, AreThoseOfTheEstimates) {
  JobSpec spec;
  spec.width = 40;
  spec.height = 30;
  spec.crop = {3, 2, 36, 27};
  spec.tile = 16;
  spec.spp = 64;
  const TestDirectory directory;
  const size_t pixels = static_cast<size_t>(spec.crop.Pixels());
  const auto plan = std::make_shared<const RoundPlan>(
      PlanCounts(0, {spec.crop, spec.tile}, std::vector<uint32_t>(pixels),
                 std::vector<uint32_t>(pixels, spec.spp / kReplicates)));
  const auto film =
      *Film::Create(directory.path() / "film", {FilmLayer::kPath, plan->grid, LayoutOf(spec)});
  OrderedMerge merge(*film, plan);
  for (uint32_t t = 0; t < plan->grid.Count(); ++t)
    merge.Add(FakeRender(spec, *plan->Unit({0, t, 0})), 1);
  const_cast<PixelCounts&>(*film->At(10, 5).counts).nonfinite = 2;

  const PixelStatistics statistics = GatherPixelStatistics(*film);
  ASSERT_EQ(statistics.size.width, 33u);
  ASSERT_EQ(statistics.size.height, 25u);
  const auto estimates = Estimate(GatherEstimateInput(*film, spec.crop));
  for (size_t i = 0; i < estimates.size(); ++i) {
    const PixelEstimate& estimate = estimates[i];
    const int x = spec.crop.x0 + static_cast<int>(i % 33),
              y = spec.crop.y0 + static_cast<int>(i / 33);
    EXPECT_EQ(statistics.samples[i], 8u);
    EXPECT_EQ(statistics.luminance[i], Luminance(estimate.mean));
    EXPECT_EQ(statistics.rays[i], static_cast<double>(film->At(x, y).counts->rays) / 64);
    EXPECT_EQ(statistics.nonfinite[i], x == 10 && y == 5);
    for (int c = 0; c < kColours; ++c) {
      const double error = estimate.standard_error[c];
      EXPECT_NEAR(statistics.variance[c][i], 64 * error * error, 1e-12);
      EXPECT_GT(error, 0);
    }
  }
}

}  // namespace
}  // namespace strata
