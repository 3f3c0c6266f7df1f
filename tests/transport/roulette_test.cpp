#include <gtest/gtest.h>

#include <numeric>

#include "tests/transport/test_scene.h"
#include "worker/integrator/roulette_map.h"

// Whatever ends paths early, the mean stays.

namespace strata {
namespace {

constexpr RouletteKind kRoulettes[] = {RouletteKind::kThroughput, RouletteKind::kOff,
                                       RouletteKind::kEfficiency};

/// Half dark, half bright: parts of the frame differ in what roulette is best for them.
TestScene Room() {
  TestScene scene;
  const MaterialId gray = scene.Diffuse(0.7f);
  scene.Polygon({{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}}, gray);
  scene.Polygon({{-4, 0, 4}, {-4, 4, 4}, {4, 4, 4}, {4, 0, 4}}, gray);
  scene.Polygon({{-4, 4, -4}, {4, 4, -4}, {4, 4, 4}, {-4, 4, 4}}, gray);
  scene.Polygon({{0, 0, -4}, {0, 0, 4}, {0, 3, 4}, {0, 3, -4}}, gray);
  scene.Polygon({{2, 3.9f, 0}, {3, 3.9f, 0}, {3, 3.9f, 1}, {2, 3.9f, 1}}, scene.Diffuse(0.0f),
                Emits(10, true));
  scene.Camera({0, 2, -8}, {0, 2, 0}, 45);
  return scene;
}

uint64_t Rays(const Partial& partial) {
  return std::accumulate(partial.rays.begin(), partial.rays.end(), uint64_t{0});
}

TEST(RouletteTest, FurnaceHoldsItsRadiance) {
  TestScene scene;
  scene.Sphere({0, 0, 0}, 1, scene.Diffuse(0.8f), Emits(0.5f), true);
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  const auto built = BuildScene(scene);
  JobSpec spec = TestSpec(16, 128, 30);
  double truth = 0, power = 0.5;
  for (int bounces = 0; bounces <= spec.max_depth; ++bounces, power *= 0.8) truth += power;
  for (const RouletteKind roulette : kRoulettes) {
    spec.roulette = roulette;
    ExpectMean(RenderFrame(built, spec), truth, roulette == RouletteKind::kOff ? 0.01 : 0.05);
  }
}

TEST(RouletteTest, KindsAgree) {
  const auto built = BuildScene(Room());
  JobSpec spec = TestSpec(24, 512, 20);
  spec.roulette = RouletteKind::kOff;
  const Partial off_frame = RenderFrame(built, spec);
  const Estimate off = FrameMean(off_frame, 1);
  for (const RouletteKind roulette : {RouletteKind::kThroughput, RouletteKind::kEfficiency}) {
    spec.roulette = roulette;
    ++spec.seed;
    const Partial frame = RenderFrame(built, spec);
    const Estimate played = FrameMean(frame, 1);
    EXPECT_TRUE(Agree(off, played))
        << off.mean << " +- " << off.standard_error << ", " << ToString(roulette) << " "
        << played.mean << " +- " << played.standard_error;
    EXPECT_FALSE(Agree({off.mean * 1.03, off.standard_error}, played));
    EXPECT_LT(static_cast<double>(Rays(frame)), 0.95 * static_cast<double>(Rays(off_frame)))
        << ToString(roulette);
  }
}

/// Where paths see a bright wall first, a weak lamp is worth few shadow rays, and loses nothing.
TEST(RouletteTest, ShadowRaysThatCanAddLittleAreSeldomTraced) {
  TestScene scene;
  scene.Sphere({0, 0, 0}, 1, scene.Diffuse(0.5f), Emits(1), true);
  scene.Light(PointLightDescription{{0, 0, 0}, Rgb::Gray(0.04f * kPi)});
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  // Lights chosen by what they give would all add alike.
  const auto built =
      BuildScene(scene, DirectorySource("."), {.selection = LightSelection::kUniform});
  JobSpec spec = TestSpec(16, 512, 1);
  const double truth = 1 + 0.5 + 0.02;
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    spec.kernel = kernel;
    spec.roulette = RouletteKind::kOff;
    const Partial all = RenderFrame(built, spec);
    ExpectMean(all, truth, 0.005);
    spec.roulette = RouletteKind::kThroughput;
    const Partial played = RenderFrame(built, spec);
    ExpectMean(played, truth, 0.005);
    // Half of the light samples are of the lamp.
    EXPECT_LT(static_cast<double>(Rays(played)), 0.9 * static_cast<double>(Rays(all)));
  }
}

TEST(RouletteTest, TheMapCoversTheFrameAndItsCellsAreItsPixels) {
  for (const auto& [width, height] : {std::pair{1, 1}, {7, 300}, {129, 64}, {65536, 40}}) {
    RouletteMap map(width, height, 0.5f);
    for (int row = 0; row < map.rows(); ++row) {
      for (int column = 0; column < map.columns(); ++column)
        map.Cell(column, row) = static_cast<float>(row * map.columns() + column);
    }
    EXPECT_EQ(map.ColumnBegin(0), 0);
    EXPECT_EQ(map.ColumnBegin(map.columns()), width);
    EXPECT_EQ(map.RowBegin(map.rows()), height);
    for (int row = 0; row < map.rows(); ++row) {
      for (int column = 0; column < map.columns(); ++column) {
        const auto cell = static_cast<float>(row * map.columns() + column);
        EXPECT_EQ(map.At(map.ColumnBegin(column), map.RowBegin(row)), cell);
        EXPECT_EQ(map.At(map.ColumnBegin(column + 1) - 1, map.RowBegin(row + 1) - 1), cell);
      }
    }
  }
}

}  // namespace
}  // namespace strata
