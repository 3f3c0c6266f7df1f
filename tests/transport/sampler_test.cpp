#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/all_samplers.h"
#include "tests/transport/test_scene.h"
#include "worker/sampling/halton.h"

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

/// The inside of a ball that emits and reflects a half: 1/2 + 1/4 + ... up to the last bounce.
std::shared_ptr<const Scene> Furnace() {
  TestScene scene;
  scene.Sphere({0, 0, 0}, 1, scene.Diffuse(0.5f), Emits(0.5f), true);
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  return BuildScene(scene);
}
constexpr int kBounces = 8;
const double kFurnaceRadiance = 1 - std::pow(0.5, kBounces + 1);

TEST(SamplerTest, FurnaceHoldsItsRadianceWithEachSamplerAndKernel) {
  const auto built = Furnace();
  JobSpec spec = TestSpec(16, 128, kBounces);
  for (const SamplerKind sampler : kAllSamplers) {
    if (sampler == SamplerKind::kHaltonPlain) continue;  // Promises no mean: see below.
    for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
      spec.sampler = sampler;
      spec.kernel = kernel;
      SCOPED_TRACE(std::string(ToString(sampler)) + ", " + std::string(ToString(kernel)));
      ExpectMeanWith(sampler, RenderFrame(built, spec), kFurnaceRadiance, 0.01, 0.03);
    }
  }
}

/// What the bare Halton sequence gives in the furnace, without light sampling. There a path's value
/// depends on roulette alone: played from the second bounce on with even odds, and a survivor's
/// every further vertex adds 1/4. Survival at bounce j is that the radical inverse of the sample's
/// index, in that coordinate's prime, is below 1/2.
double FurnaceByPlainHalton(uint64_t samples) {
  double sum = 0;
  for (uint64_t i = 0; i < samples; ++i) {
    sum += 0.75;
    for (uint32_t j = 1; j < kBounces; ++j) {
      const uint32_t pair = kPairFirstBounce + j * kPairsPerBounce + kPairSelect;
      if (RadicalInverse(HaltonBase(HaltonDimension(pair) + 1), i) >= 1u << 23) break;
      sum += 0.25;
    }
  }
  return sum / static_cast<double>(samples);
}

/// halton_plain promises neither an unbiased mean, nothing in it being random, nor a good one from
/// few points: it promises the first points of Halton's sequence, and so the truth in the limit. Of
/// a prime p above the number n of points these are 0, 1/p, ... (n - 1)/p, so that late bounces, of
/// primes up to 349, see small numbers alone and hardly a path of 128 is ended.
TEST(SamplerTest, PlainHaltonErrsInTheFurnaceAsItsPointsDoAndFindsTheTruthInTheEnd) {
  const auto built = Furnace();
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    for (const uint32_t samples : {128u, 2048u, 16384u}) {
      JobSpec spec = TestSpec(2, samples, kBounces);
      spec.sampler = SamplerKind::kHaltonPlain;
      spec.kernel = kernel;
      const Partial frame = RenderFrame(built, spec, DirectStrategy::kBsdfOnly);
      EXPECT_NEAR(FrameMean(frame, 1).mean, FurnaceByPlainHalton(samples), 1e-5)
          << ToString(kernel) << ", " << samples;
    }
  }
  // Arithmetic: 39 %, 3 %, 0.2 %. A sequence that did not fill its coordinates would stay far off.
  EXPECT_GT(FurnaceByPlainHalton(128), 1.3 * kFurnaceRadiance);
  EXPECT_NEAR(FurnaceByPlainHalton(2048) / kFurnaceRadiance, 1, 0.03);
  EXPECT_NEAR(FurnaceByPlainHalton(16384) / kFurnaceRadiance, 1, 0.003);
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
