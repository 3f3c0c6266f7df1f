#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/statistics/density_checks.h"
#include "tests/statistics/random.h"
#include "worker/light/glow_guide.h"
#include "worker/medium/near_lamps.h"

// Directions and distances to the glow of lamps in media.

namespace strata {
namespace {

LightBounds Lamp(Vec3f p, float size, float intensity) {
  LightBounds bounds = {p, p + Vec3f{size, 0, 0}};
  bounds.intensity = intensity;
  return bounds;
}

void ExpectDensitiesOfGlows(const DensityEffort& effort) {
  struct Case {
    const char* name;
    std::vector<LightBounds> lamps;
  };
  const std::vector<Case> cases = {
      {"a lamp", {Lamp({1, 2, 0.5f}, 0.1f, 1)}},
      {"three lamps",
       {Lamp({1, 2, 0.5f}, 0.1f, 0.5f), Lamp({-1, 1, 0}, 0, 0.3f), Lamp({0, -1, 4}, 1, 0.2f)}},
  };
  DensityChecks checks(cases.size(), effort);
  TestRandom random(4);
  for (const Case& c : cases) {
    GlowGuide guide;
    guide.Start(LampPlaces(c.lamps), {}, {0.5f, 0.6f});
    ASSERT_GT(guide.share(), 0) << c.name;
    const Frame frame = Frame::FromNormal(Normalize(c.lamps[0].Center()));
    const DirectionTestResult result = checks.ExpectDirections(
        c.name,
        [&]() -> std::optional<Vec3f> {
          const float u = random.Float();
          return frame.ToLocal(guide.Sample(u, random.Float2()));
        },
        [&](Vec3f w) { return guide.Pdf(frame.ToWorld(w)); });
    EXPECT_NEAR(result.integral, 1, 2e-3) << c.name;
  }
}
TEST(GlowGuide, FollowsItsDensity) { ExpectDensitiesOfGlows({200'000, {}}); }
TEST(GlowGuide, DISABLED_IsToldFromOnePercentOfShape) { ExpectDensitiesOfGlows(kByHand); }

TEST(GlowGuide, HasNoShareWithoutHazeOrBehindMuchOfIt) {
  const LampPlaces lamps({Lamp({1, 2, 0.5f}, 0.1f, 1)});
  GlowGuide guide;
  guide.Start(lamps, {}, {0, 1});
  EXPECT_EQ(guide.share(), 0);
  guide.Start(lamps, {}, {10, 10});
  EXPECT_LT(guide.share(), 1e-6);
  guide.Start(lamps, {}, {0.4f, 0.4f});
  EXPECT_GT(guide.share(), 0.3);
  // Within the lamp.
  guide.Start(lamps, {1.05f, 2, 0.5f}, {0.4f, 0.4f});
  EXPECT_EQ(guide.share(), 0);
}

/// The density is that of angles seen from the lamps: its integral up to a distance is known.
TEST(NearLamps, DistancesAreEvenInTheirAngle) {
  const std::vector<LightBounds> lamps = {Lamp({0.3f, 0, 0.7f}, 0, 1),
                                          Lamp({0, -1, 1.9f}, 0, 0.3f)};
  constexpr double kLength = 2.5, kExtinction = 0.4;
  const NearLamps near(LampPlaces(lamps), {}, {0, 0, 1}, kLength, kExtinction);
  ASSERT_GT(near.part(), 0.3);
  const double heights[] = {0.3, 1}, nearest[] = {0.7, 1.9}, intensities[] = {1, 0.3};
  const auto passed = [&](double t) {
    double sum = 0;
    for (int i = 0; i < 2; ++i) {
      const double angle =
          std::atan((t - nearest[i]) / heights[i]) + std::atan(nearest[i] / heights[i]);
      sum +=
          intensities[i] / heights[i] * std::exp(-kExtinction * (nearest[i] + heights[i])) * angle;
    }
    return sum;
  };
  constexpr int kBins = 100, kDraws = 10'000'000;
  std::vector<double> observed(kBins), expected(kBins), control(kBins);
  TestRandom random(6);
  for (int i = 0; i < kDraws; ++i) {
    const double t = near.Sample(random.Float());
    ++observed[std::min(static_cast<size_t>(t * kBins / kLength), size_t{kBins - 1})];
  }
  for (int bin = 0; bin < kBins; ++bin) {
    const double a = bin * kLength / kBins, b = (bin + 1) * kLength / kBins;
    expected[bin] = kDraws * (passed(b) - passed(a)) / passed(kLength);
    EXPECT_NEAR(near.Pdf(static_cast<float>((a + b) / 2)) * (b - a) * kDraws / expected[bin], 1,
                2e-3);
    control[bin] = expected[bin] * (1 + 0.01 * std::cos(2 * std::numbers::pi * bin / kBins));
  }
  EXPECT_GT(ChiSquareTest(observed, expected).p, 1e-3);
  EXPECT_LT(ChiSquareTest(observed, control).p, kControlLevel);
}

}  // namespace
}  // namespace strata
