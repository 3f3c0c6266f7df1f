#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/random.h"
#include "worker/light/light_set.h"

// LightSet::Select chooses each light as often as Probability says.

namespace strata {
namespace {

constexpr double kAlpha = 0.01;  ///< Of each test as a whole, shared out by Sidak's rule.
constexpr int kSamples = 1000000;

/// Point lights of these intensities around a disk.
struct PointLights {
  explicit PointLights(const std::vector<float>& intensities) {
    SceneDescription scene;
    scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
    scene.materials.push_back(DiffuseMaterial{0});
    scene.shapes.emplace_back().geometry = DiskShape{};
    for (const float intensity : intensities)
      scene.lights.push_back({{}, PointLightDescription{{0, 0, 1}, Rgb::Gray(intensity)}});
    auto built = Geometry::Build(scene);
    EXPECT_TRUE(built.ok()) << built.status();
    geometry = *std::move(built);
    auto lights = LightSet::Build(scene, *geometry, DirectorySource("."));
    EXPECT_TRUE(lights.ok()) << lights.status();
    set = *std::move(lights);
  }

  std::unique_ptr<Geometry> geometry;
  LightSet set;
};

/// What Select did with kSamples random numbers.
struct Choices {
  std::vector<double> counts;
  std::vector<std::vector<double>> rests;  ///< Of each light the first few Choice::u.
};

Choices Choose(const LightSet& set, uint64_t seed) {
  const size_t n = set.lights().size();
  Choices choices = {std::vector<double>(n, 0), std::vector<std::vector<double>>(n)};
  TestRandom random(seed);
  for (int i = 0; i < kSamples; ++i) {
    const Vec2f u = random.Float2();
    const LightSet::Choice choice = set.Select(u.x, u.y);
    EXPECT_EQ(choice.probability, set.Probability(choice.light));
    EXPECT_TRUE(choice.u >= 0 && choice.u < 1) << choice.u;
    ++choices.counts[choice.light];
    std::vector<double>& rests = choices.rests[choice.light];
    if (rests.size() < 10000) rests.push_back(choice.u);
  }
  return choices;
}

std::vector<std::vector<float>> AllIntensities() {
  std::vector<float> many(300), geometric;
  std::iota(many.begin(), many.end(), 1.0f);
  for (float intensity = 1e-8f; intensity < 1e9f; intensity *= 10) geometric.push_back(intensity);
  return {{1, 1}, {1, 3, 2, 0, 5}, {1e-20f, 1, 1, 1e-20f}, {0, 1e30f, 1e30f, 1, 0}, {0, 0, 0},
          many,   geometric};
}

TEST(LightSelection, CountsFollowTheProbability) {
  const auto cases = AllIntensities();
  const double level = SidakLevel(kAlpha, static_cast<int>(cases.size()));
  uint64_t seed = 1;
  for (const std::vector<float>& intensities : cases) {
    SCOPED_TRACE(testing::PrintToString(intensities));
    const PointLights lights(intensities);
    const Choices choices = Choose(lights.set, seed++);
    std::vector<double> expected;
    for (uint32_t i = 0; i < intensities.size(); ++i)
      expected.push_back(double{lights.set.Probability(i)} * kSamples);
    EXPECT_NEAR(std::accumulate(expected.begin(), expected.end(), 0.0), kSamples, 1e-6 * kSamples);
    EXPECT_GT(ChiSquareTest(choices.counts, expected).p, level);
    // The control: every other light 3 % more likely than it is against the rest.
    double sum = 0;
    for (size_t i = 0; i < expected.size(); ++i) sum += expected[i] *= i % 2 ? 1.03 : 1;
    for (double& e : expected) e *= kSamples / sum;
    EXPECT_LT(ChiSquareTest(choices.counts, expected).p, 1e-6);
  }
}

TEST(LightSelection, LeavesTheRestOfTheNumberUniform) {
  const auto cases = AllIntensities();
  std::vector<double> values;
  uint64_t seed = 100;
  for (const std::vector<float>& intensities : cases) {
    const Choices choices = Choose(PointLights(intensities).set, seed++);
    for (const std::vector<double>& rests : choices.rests) {
      if (rests.size() >= 1000) values.push_back(KolmogorovSmirnovUniform(rests));
    }
  }
  const double level = SidakLevel(kAlpha, static_cast<int>(values.size()));
  for (const double p : values) EXPECT_GT(p, level);
  // The control: numbers of the density 1 + 0.1 (1 - 2u).
  TestRandom random(9);
  std::vector<double> bent;
  for (int i = 0; i < 10000; ++i) {
    const double u = random.Double();
    bent.push_back(u + 0.1 * u * (1 - u));
  }
  EXPECT_LT(KolmogorovSmirnovUniform(bent), level);
}

TEST(LightSelection, NeverTakesABlackLightAndNowAndThenAFaintOne) {
  const PointLights lights({0, 1e8f, 1e-8f, 0});
  EXPECT_EQ(lights.set.Probability(0), 0);
  EXPECT_EQ(lights.set.Probability(3), 0);
  EXPECT_GE(lights.set.Probability(2), 0.004f);
  constexpr float kLast = 1 - 0x1p-24f;
  for (const Vec2f u : {Vec2f{0, 0}, Vec2f{kLast, kLast}}) {
    const LightSet::Choice choice = lights.set.Select(u.x, u.y);
    EXPECT_GT(choice.probability, 0);
    EXPECT_LT(choice.u, 1);
  }
}

}  // namespace
}  // namespace strata
