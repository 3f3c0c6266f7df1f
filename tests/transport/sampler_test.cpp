#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/transport/test_scene.h"

// Whole paths with each sampler, against a closed form.

namespace strata {
namespace {

/// Where no interval is claimed, the mean has to be within `tolerance`.
void ExpectMeanWith(SamplerKind sampler, const Partial& frame, double truth, double detectable,
                    double tolerance) {
  if (ClaimsInterval(sampler)) {
    ExpectMean(frame, truth, detectable);
  } else {
    EXPECT_NEAR(FrameMean(frame, 1).mean / truth, 1, tolerance);
  }
}

TEST(SamplerTest, FurnaceHoldsItsRadianceWithEachSamplerAndKernel) {
  TestScene scene;
  scene.Sphere({0, 0, 0}, 1, scene.Diffuse(0.5f), Emits(0.5f), true);
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  const auto built = BuildScene(scene);
  JobSpec spec = TestSpec(16, 128, 8);
  const double truth = 1 - std::pow(0.5, 9);
  for (const SamplerKind sampler : kAllSamplers) {
    // The same few points of all pixels leave the late bounces' coordinates, of great primes, far
    // from even: the frame's mean errs by a quarter.
    if (sampler == SamplerKind::kHaltonPlain) continue;
    for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
      spec.sampler = sampler;
      spec.kernel = kernel;
      SCOPED_TRACE(std::string(ToString(sampler)) + ", " + std::string(ToString(kernel)));
      ExpectMeanWith(sampler, RenderFrame(built, spec), truth, 0.01, 0.03);
    }
  }
}

/// A sphere of radius R at distance d lights a floor with pi L (R / d)^2.
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
      if (strategy == DirectStrategy::kMis) {
        ExpectMeanWith(sampler, frame, truth, 0.01, 0.02);
      } else {
        ExpectMeanWith(sampler, frame, truth, 0.08, 0.1);
      }
    }
  }
}

}  // namespace
}  // namespace strata
