#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "tests/light/lamps.h"
#include "tests/statistics/density_checks.h"
#include "tests/statistics/random.h"
#include "worker/light/light_set.h"

// LightSet::Select chooses each light as often as Probability says, and none that cannot be seen.
// A probability is looked up rather than integrated: its error of shape is that every other light
// is more likely than it is against the rest, by 3 %, and by 1 % by hand:
//
//   test_light --gtest_also_run_disabled_tests --gtest_filter='*OnePercentOfShape*'

namespace strata {
namespace {

constexpr DensityEffort kEveryDay = {1'000'000, 0.03};

/// A point that looks at them.
constexpr LightReceiver kReceiver = {{0.3f, 0.1f, -0.2f}, {0, 0, 1}};

/// The lights of a scene with a dark disk.
struct TestLights {
  /// Point lights of these intensities, all at one place.
  explicit TestLights(const std::vector<float>& intensities) {
    SceneDescription scene;
    for (const float intensity : intensities)
      scene.lights.push_back({{}, PointLightDescription{{0, 0, 1}, Rgb::Gray(intensity)}});
    Build(std::move(scene), {});
  }
  TestLights(SceneDescription scene, const BuildOptions& options) {
    Build(std::move(scene), options);
  }

  void Build(SceneDescription scene, const BuildOptions& options) {
    scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
    scene.materials.push_back(DiffuseMaterial{0});
    scene.shapes.emplace_back().geometry = DiskShape{};
    auto built = Geometry::Build(scene);
    EXPECT_TRUE(built.ok()) << built.status();
    geometry = *std::move(built);
    const DirectorySource none(".");
    textures = *TextureSet::Load(scene.textures, none);
    auto lights = LightSet::Build(scene, *geometry, *textures, none, options);
    EXPECT_TRUE(lights.ok()) << lights.status();
    set = *std::move(lights);
  }

  std::unique_ptr<Geometry> geometry;
  std::unique_ptr<TextureSet> textures;
  LightSet set;
};

/// What Select did with random numbers.
struct Choices {
  std::vector<double> counts;
  std::vector<std::vector<double>> rests;  ///< Of each light the first few Choice::u.

  double Found() const { return std::accumulate(counts.begin(), counts.end(), 0.0); }
};

Choices Choose(const LightSet& set, uint64_t seed, int samples,
               const LightReceiver& receiver = kReceiver) {
  const size_t n = set.lights().size();
  Choices choices = {std::vector<double>(n, 0), std::vector<std::vector<double>>(n)};
  TestRandom random(seed);
  for (int i = 0; i < samples; ++i) {
    const Vec2f u = random.Float2();
    const LightSet::Choice choice = set.Select(receiver, u.x, u.y);
    if (choice.probability == 0) continue;
    EXPECT_EQ(choice.probability, set.Probability(choice.light, receiver));
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

/// Of counts and what is expected by the probabilities, which have the sum of the counts.
void ExpectChoices(DensityChecks* checks, const std::string& name, std::vector<double> counts,
                   std::vector<double> expected) {
  std::vector<double> wrong = expected;
  double sum = 0, wrong_sum = 0;
  for (size_t i = 0; i < wrong.size(); ++i) {
    sum += expected[i];
    wrong_sum += wrong[i] *= i % 2 ? 1 + checks->ErrorOr(*kEveryDay.error) : 1;
  }
  for (double& e : wrong) e *= sum / wrong_sum;
  checks->Expect(name, ChiSquareTest(counts, expected), ChiSquareTest(counts, wrong));
}

std::vector<double> ExpectedChoices(const LightSet& set, const LightReceiver& receiver,
                                    int samples) {
  std::vector<double> expected;
  for (uint32_t i = 0; i < set.lights().size(); ++i)
    expected.push_back(double{set.Probability(i, receiver)} * samples);
  return expected;
}

void ExpectProbabilitiesOfIntensities(const DensityEffort& effort) {
  const auto cases = AllIntensities();
  DensityChecks checks(cases.size(), effort);
  uint64_t seed = 1;
  for (const std::vector<float>& intensities : cases) {
    const std::string name = testing::PrintToString(intensities);
    const TestLights lights(intensities);
    const Choices choices = Choose(lights.set, seed++, effort.samples);
    const std::vector<double> expected = ExpectedChoices(lights.set, kReceiver, effort.samples);
    EXPECT_NEAR(std::accumulate(expected.begin(), expected.end(), 0.0), effort.samples,
                1e-6 * effort.samples)
        << name;
    ExpectChoices(&checks, name, choices.counts, expected);
  }
}
TEST(LightSelection, CountsFollowTheProbability) { ExpectProbabilitiesOfIntensities(kEveryDay); }
TEST(LightSelection, DISABLED_CountsAreToldFromOnePercentOfShape) {
  ExpectProbabilitiesOfIntensities(kByHand);
}

TEST(LightSelection, LeavesTheRestOfTheNumberUniform) {
  const auto cases = AllIntensities();
  std::vector<double> values;
  uint64_t seed = 100;
  for (const std::vector<float>& intensities : cases) {
    const Choices choices = Choose(TestLights(intensities).set, seed++, kEveryDay.samples);
    for (const std::vector<double>& rests : choices.rests) {
      if (rests.size() >= 1000) values.push_back(KolmogorovSmirnovUniform(rests));
    }
  }
  const double level = SidakLevel(0.01, static_cast<int>(values.size()));
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

TEST(LightSelection, TakesAllAlikeIfAskedToFromAfarToo) {
  SceneDescription scene;
  for (const float power : {1.0f, 100.0f}) {
    scene.lights.push_back({{}, PointLightDescription{{0, 0, 1}, Rgb::Gray(power)}});
    scene.lights.push_back({{}, DistantLightDescription{{0, 0, 1}, Rgb::Gray(power)}});
  }
  const TestLights even(scene, {.selection = LightSelection::kUniform});
  const TestLights tree(scene, {});
  for (uint32_t light = 0; light < 4; ++light) {
    EXPECT_FLOAT_EQ(even.set.Probability(light, kReceiver), 0.25f) << light;
    EXPECT_GT(std::abs(tree.set.Probability(light, kReceiver) - 0.25f), 0.05f) << light;
  }
}

TEST(LightSelection, NeverTakesABlackLightAndNowAndThenAFaintOne) {
  const TestLights lights({0, 1e8f, 1e-8f, 0});
  EXPECT_EQ(lights.set.Probability(0, kReceiver), 0);
  EXPECT_EQ(lights.set.Probability(3, kReceiver), 0);
  EXPECT_GE(lights.set.Probability(2, kReceiver), 0.004f);
  constexpr float kLast = 1 - 0x1p-24f;
  for (const Vec2f u : {Vec2f{0, 0}, Vec2f{kLast, kLast}}) {
    const LightSet::Choice choice = lights.set.Select(kReceiver, u.x, u.y);
    EXPECT_GT(choice.probability, 0);
    EXPECT_LT(choice.u, 1);
  }
}

void ExpectProbabilitiesOfTrees(const DensityEffort& effort) {
  const std::vector<LightReceiver> receivers = {{{0, 0, 0}, {0, 0, 1}, true},
                                                {{4, -3, 6}, Normalize(Vec3f{-1, 1, -1}), false},
                                                {{30, 5, 0}, {1, 0, 0}, true},
                                                {{-5, -5, -5}, {0, 1, 0}, true}};
  const std::vector<LightSelection> selections = {LightSelection::kTree, LightSelection::kIntensity,
                                                  LightSelection::kUniform};
  DensityChecks checks(receivers.size() * selections.size(), effort);
  const SceneDescription scene = ManyLamps(100, 7);
  uint64_t seed = 200;
  for (const LightSelection selection : selections) {
    const TestLights lights(scene, {.selection = selection});
    for (const LightReceiver& receiver : receivers) {
      const Choices choices = Choose(lights.set, seed++, effort.samples, receiver);
      std::vector<double> counts = choices.counts,
                          expected = ExpectedChoices(lights.set, receiver, effort.samples);
      // What is left is where no light was found.
      counts.push_back(effort.samples - choices.Found());
      expected.push_back(effort.samples - std::accumulate(expected.begin(), expected.end(), 0.0));
      EXPECT_GT(expected.back(), -1e-6 * effort.samples);
      if (expected.back() < 1e-6 * effort.samples) {
        EXPECT_LT(counts.back(), 2e-5 * effort.samples);
        counts.pop_back();
        expected.pop_back();
      }
      // With its back to all lamps, the third receiver has too few choices to tell an error by.
      if (choices.Found() < effort.samples / 2) {
        EXPECT_GT(ChiSquareTest(counts, expected).p, checks.level());
      } else {
        ExpectChoices(&checks, "receiver " + std::to_string(seed), counts, expected);
      }
    }
  }
}
TEST(LightSelection, TreesChooseAsTheySay) { ExpectProbabilitiesOfTrees(kEveryDay); }
TEST(LightSelection, DISABLED_TreesAreToldFromOnePercentOfShape) {
  ExpectProbabilitiesOfTrees(kByHand);
}

TEST(LightSelection, WhateverGivesLightMayBeChosen) {
  // Every lamp is asked from everywhere: where it sends light to, it has a chance of more than the
  // even share alone, which is 0.01 / n.
  const TestLights lights(ManyLamps(300, 11), {});
  // A little more: next to nothing of a lamp may be above the horizon.
  const float even = 1.00001f * (0.01f / static_cast<float>(lights.set.lights().size()));
  TestRandom random(12);
  int lit = 0, dark = 0;
  for (int i = 0; i < 100000; ++i) {
    const auto coordinate = [&] { return static_cast<float>(16 * random.Double() - 8); };
    const LightReceiver receiver = {{coordinate(), coordinate(), coordinate()},
                                    Normalize(Vec3f{coordinate(), coordinate(), coordinate()}),
                                    true};
    const uint32_t light =
        static_cast<uint32_t>(random.Double() * static_cast<double>(lights.set.lights().size()));
    const auto sample = lights.set.Sample(light, receiver.p, random.Float2());
    const float probability = lights.set.Probability(light, receiver);
    if (sample && Dot(sample->wi, receiver.n) > 0) {
      ++lit;
      EXPECT_GT(probability, even) << light;
    } else {
      dark += probability <= even;
    }
  }
  EXPECT_GT(lit, 20000);
  EXPECT_GT(dark, 10000);  // And many of those that give none have no more than that.
}

}  // namespace
}  // namespace strata
