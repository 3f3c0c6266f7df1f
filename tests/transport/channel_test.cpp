#include <gtest/gtest.h>

#include <cmath>

#include "tests/transport/test_scene.h"

// What a pixel's value means: filters, extra channels, samples that are not finite.

namespace strata {
namespace {

class FilterOfFrame : public testing::TestWithParam<FilterKind> {};

TEST_P(FilterOfFrame, KeepsAConstantImageConstant) {
  TestScene scene;
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(0.75f)});
  JobSpec spec = TestSpec(16, 64, 1);
  spec.filter = DefaultFilter(GetParam());
  const Estimate estimate = FrameMean(RenderFrame(BuildScene(scene), spec), 1);
  EXPECT_TRUE(Agrees(estimate, 0.75)) << estimate.mean << " +- " << estimate.standard_error;
  EXPECT_FALSE(Agrees(estimate, 0.75 * 1.02));
}

/// The filter's integral over offsets beyond `edge` in one axis, by the midpoint rule.
double ShareBeyond(const FilterSpec& spec, double edge) {
  const auto mitchell = [&](double x) {
    const double b = spec.b, c = spec.c;
    x = std::abs(2 * x / spec.radius_x);
    if (x >= 2) return 0.0;
    if (x > 1)
      return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
              (8 * b + 24 * c)) /
             6;
    return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
  };
  const auto value = [&](double x) {
    switch (spec.kind) {
      case FilterKind::kBox:
        return 1.0;
      case FilterKind::kTriangle:
        return spec.radius_x - std::abs(x);
      case FilterKind::kGaussian:
        return std::exp(-x * x / (2 * spec.sigma * spec.sigma)) -
               std::exp(-spec.radius_x * spec.radius_x / (2 * spec.sigma * spec.sigma));
      case FilterKind::kMitchell:
        return mitchell(x);
    }
    return 0.0;
  };
  constexpr int kSteps = 20000;
  double total = 0, beyond = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double x = (2 * (i + 0.5) / kSteps - 1) * spec.radius_x;
    total += value(x);
    if (x > edge) beyond += value(x);
  }
  return beyond / total;
}

TEST_P(FilterOfFrame, BlursAnEdgeByItsIntegral) {
  // A lamp that fills x >= 0 before a camera whose pixels are 1 unit wide at its distance.
  TestScene scene;
  constexpr int kSize = 8;
  scene.Polygon({{0, -50, 10}, {0, 50, 10}, {50, 50, 10}, {50, -50, 10}}, scene.Diffuse(0.0f),
                Emits(1, true));
  scene.Camera({0.3f, 0, 0}, {0.3f, 0, 1},
               2 * 180 / 3.14159265358979 * std::atan(kSize / 2 / 10.0));
  JobSpec spec = TestSpec(kSize, 1024, 0);
  spec.filter = DefaultFilter(GetParam());
  const Partial partial = RenderFrame(BuildScene(scene), spec);
  for (int x = 0; x < kSize; ++x) {
    // The column's pixels have one expectation; edge - center in pixels.
    const double edge = -0.3 - (x + 0.5 - kSize / 2);
    const double truth = ShareBeyond(spec.filter, edge);
    double sum = 0, squares = 0;
    for (int y = 0; y < kSize; ++y)
      for (int r = 0; r < kReplicates; ++r) {
        const double value =
            partial.values[(y * kSize + x) * partial.layout.Doubles() + partial.layout.Mean(r, 1)];
        sum += value;
        squares += value * value;
      }
    constexpr int n = kSize * kReplicates;
    const double mean = sum / n;
    const double error = std::sqrt(std::max(0.0, squares / n - mean * mean) / (n - 1));
    // The sampler's filter is piecewise linear to 1e-3 of its peak.
    EXPECT_NEAR(mean, truth, kCritical * error + 2e-3) << "column " << x;
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, FilterOfFrame,
                         testing::Values(FilterKind::kBox, FilterKind::kTriangle,
                                         FilterKind::kGaussian, FilterKind::kMitchell),
                         [](const auto& kind) { return std::string(ToString(kind.param)); });

TEST(ChannelTest, DescribeTheFirstHit) {
  TestScene scene;
  scene.Polygon({{-9, -9, 4}, {-9, 9, 4}, {0, 9, 4}, {0, -9, 4}},
                scene.Diffuse({0.2f, 0.4f, 0.6f}));
  scene.Camera({0, 0, 1}, {0, 0, 2}, 60);
  JobSpec spec = TestSpec(2, 64, 0);
  spec.channels = {.alpha = true, .albedo = true, .normal = true, .depth = true};
  const Partial partial = RenderFrame(BuildScene(scene), spec);
  const auto plain = [&](int pixel, int channel) {
    return partial.values[pixel * partial.layout.Doubles() + partial.layout.Plain(channel)];
  };
  // x is to the right of the picture: the left pixels see the wall, the right ones nothing.
  const double wall[8] = {1, 0.2, 0.4, 0.6, 0, 0, -1, 3};
  for (int channel = 0; channel < 8; ++channel) {
    const double sign = channel == 6 ? std::copysign(1, plain(0, 6)) : 1;
    EXPECT_NEAR(std::abs(plain(0, channel)), std::abs(wall[channel]), 1e-5) << channel << sign;
    EXPECT_EQ(plain(1, channel), 0) << channel;
  }
}

TEST(ChannelTest, SamplesThatAreNotFiniteCountAsZeroAndNameTheirReplay) {
  // The sky is as bright as a float can be; a diffuse surface under it overflows.
  TestScene scene;
  scene.Polygon({{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}, scene.Diffuse(1.0f));
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(3e38f)});
  scene.Camera({0, 3, 0}, {0, 0, 0}, 30);
  const JobSpec spec = TestSpec(4, 64, 1);
  const auto built = BuildScene(scene);
  const Partial partial = RenderFrame(built, spec);
  uint64_t nonfinite = 0;
  for (int64_t pixel = 0; pixel < 16; ++pixel) {
    nonfinite += partial.nonfinite[pixel];
    EXPECT_EQ(partial.samples[pixel], 8u);
    EXPECT_LE(partial.nonfinite[pixel], 64u);
  }
  EXPECT_GT(nonfinite, 0u);
  for (double value : partial.values) EXPECT_TRUE(std::isfinite(value));
  ASSERT_FALSE(partial.replays.empty());
  EXPECT_LE(partial.replays.size(), 4u);
  int x = -1, y = -1, replicate = -1, sample = -1;
  ASSERT_EQ(std::sscanf(partial.replays[0].c_str(),
                        "strata replay test.pbrt --pixel %d,%d --replicate %d --sample %d", &x, &y,
                        &replicate, &sample),
            4)
      << partial.replays[0];
  auto renderer = Renderer::Create(built, spec);
  ASSERT_TRUE(renderer.ok());
  const std::string told = (*renderer)->Replay(x, y, replicate, sample);
  EXPECT_NE(told.find("not finite"), std::string::npos) << told;
}

}  // namespace
}  // namespace strata
