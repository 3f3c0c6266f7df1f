#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/transport/test_scene.h"

// Whole paths with each sampler, against a closed form.

namespace strata {
namespace {

/// Paths of up to 8 bounces in a furnace of unlike parts: pixels see the wall itself and a glass
/// ball before it, which changes nothing, since radiance is the same everywhere.
TEST(SamplerTest, FurnaceHoldsItsRadianceWithEachSamplerAndKernel) {
  TestScene scene;
  scene.Sphere({0, 0, 0}, 1, scene.Diffuse(0.5f), Emits(0.5f), true);
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  const auto built = BuildScene(scene);
  JobSpec spec = TestSpec(16, 128, 8);
  const double truth = 1 - std::pow(0.5, 9);
  for (const SamplerKind sampler : kAllSamplers) {
    for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
      spec.sampler = sampler;
      spec.kernel = kernel;
      SCOPED_TRACE(std::string(ToString(sampler)) + ", " + std::string(ToString(kernel)));
      ExpectMean(RenderFrame(built, spec), truth, 0.01);
    }
  }
}

/// A sphere of radius R at distance d lights a floor with pi L (R / d)^2 cos: found by light and
/// BSDF sampling alike.
TEST(SamplerTest, IrradianceOfASphereWithEachSampler) {
  TestScene scene;
  constexpr float kReflectance = 0.6f, kRadiance = 5, kRadius = 1, kHeight = 2;
  scene.Polygon({{-50, 0, -50}, {-50, 0, 50}, {50, 0, 50}, {50, 0, -50}},
                scene.Diffuse(kReflectance));
  scene.Sphere({0, kHeight, 0}, kRadius, scene.Diffuse(0.0f), Emits(kRadiance));
  scene.Camera({1, 0.5f, 3}, {0, 0, 0}, 0.01f);
  const auto built = BuildScene(scene);
  const double truth = double{kReflectance} * kRadiance * kRadius * kRadius / (kHeight * kHeight);
  JobSpec spec = TestSpec(16, 256, 1);
  for (const SamplerKind sampler : kAllSamplers) {
    spec.sampler = sampler;
    for (const DirectStrategy strategy :
         {DirectStrategy::kMis, DirectStrategy::kBsdfOnly, DirectStrategy::kUniform}) {
      const Partial frame = RenderFrame(built, spec, strategy);
      SCOPED_TRACE(std::string(ToString(sampler)) + ", " + std::string(ToString(strategy)));
      if (ClaimsInterval(sampler)) {
        ExpectMean(frame, truth, 0.03);
      } else {  // What there is instead of an interval.
        const double tolerance = strategy == DirectStrategy::kMis ? 0.005 : 0.05;
        EXPECT_NEAR(FrameMean(frame, 1).mean / truth, 1, tolerance);
      }
    }
  }
}

}  // namespace
}  // namespace strata
