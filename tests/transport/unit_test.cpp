#include <gtest/gtest.h>
#include <immintrin.h>

#include <bit>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "common/build_info.h"
#include "common/digest.h"
#include "common/kernel_revision.h"
#include "common/moments.h"
#include "common/unit.h"
#include "tests/all_samplers.h"
#include "tests/transport/test_scene.h"

// A unit's partial is a pure function of (scene, spec, unit): the same bits however the frame is
// cut and whichever threads render it.

namespace strata {
namespace {

TestScene Scene3() {
  TestScene scene;
  scene.Polygon({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}},
                scene.Diffuse({0.8f, 0.5f, 0.2f}));
  scene.Sphere({0, 1, 0}, 0.7f, scene.Material(DielectricMaterial{}));
  scene.Sphere({1.5f, 2, -1}, 0.3f, scene.Diffuse(0.0f), Emits(10));
  scene.Light(ConstantInfiniteLightDescription{{0.1f, 0.2f, 0.3f}});
  scene.Camera({0, 1.5f, -5}, {0, 0.8f, 0}, 40);
  return scene;
}

std::unique_ptr<Renderer> MakeRenderer(const JobSpec& spec) {
  auto renderer = Renderer::Create(BuildScene(Scene3()), spec);
  EXPECT_TRUE(renderer.ok()) << renderer.status();
  return *std::move(renderer);
}

/// All doubles and rays of a frame that is rendered tile by tile, in frame order.
std::vector<double> RenderTiled(const Renderer& renderer, const JobSpec& spec, int tile,
                                int threads) {
  RenderPool pool(threads);
  const int doubles = LayoutOf(spec).Doubles();
  std::vector<double> frame(static_cast<size_t>(spec.width) * spec.height * (doubles + 1));
  for (int y = 0; y < spec.height; y += tile) {
    for (int x = 0; x < spec.width; x += tile) {
      const PixelRect rect = {x, y, std::min(x + tile, spec.width),
                              std::min(y + tile, spec.height)};
      const auto partial = renderer.Render({{}, rect, {{0, 4}}}, pool);
      EXPECT_TRUE(partial.ok()) << partial.status();
      for (int64_t i = 0; i < rect.Pixels(); ++i) {
        const size_t at = (rect.y0 + i / rect.Width()) * spec.width + rect.x0 + i % rect.Width();
        double* to = &frame[at * (doubles + 1)];
        std::copy_n(&partial->values[i * doubles], doubles, to);
        to[doubles] = static_cast<double>(partial->rays[i]);
      }
    }
  }
  return frame;
}

bool SameBits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(UnitTest, SameBitsForAnyTileAndThreads) {
  JobSpec spec = TestSpec(40, 32, 6);
  spec.channels = {.alpha = true, .albedo = true, .normal = true, .depth = true};
  for (const SamplerKind sampler : kAllSamplers) {
    spec.sampler = sampler;
    spec.roulette =
        sampler == SamplerKind::kHalton ? RouletteKind::kEfficiency : RouletteKind::kThroughput;
    spec.filter = DefaultFilter(FilterKind::kMitchell);
    const auto renderer = MakeRenderer(spec);
    const std::vector<double> whole = RenderTiled(*renderer, spec, 40, 1);
    for (const auto& [tile, threads] : {std::pair{8, 1}, {16, 4}, {33, 3}, {40, 7}})
      EXPECT_TRUE(SameBits(whole, RenderTiled(*renderer, spec, tile, threads)))
          << ToString(sampler) << ": tile " << tile << ", " << threads << " threads";
  }
}

TEST(UnitTest, AnotherSeedFrameOrPixelGivesOtherBits) {
  JobSpec spec = TestSpec(16, 32, 6);
  const std::vector<double> base = RenderTiled(*MakeRenderer(spec), spec, 16, 2);
  spec.seed = 8;
  EXPECT_FALSE(SameBits(base, RenderTiled(*MakeRenderer(spec), spec, 16, 2)));
  spec.seed = 7;
  spec.frame = 1;
  EXPECT_FALSE(SameBits(base, RenderTiled(*MakeRenderer(spec), spec, 16, 2)));
}

TEST(UnitTest, PiecesMergeToTheMomentsOfTheWhole) {
  const JobSpec spec = TestSpec(8, 96 * kReplicates, 6);
  const auto renderer = MakeRenderer(spec);
  RenderPool pool(2);
  const auto whole = renderer->Render({{}, spec.crop, {{0, 96}}}, pool);
  ASSERT_TRUE(whole.ok());
  const PixelLayout layout = whole->layout;
  for (int64_t pixel = 0; pixel < spec.crop.Pixels(); ++pixel) {
    Moments merged;
    for (const SampleRange& piece : CutPieces({0, 96})) {
      const PixelRect rect = {int(pixel % 8), int(pixel / 8), int(pixel % 8) + 1,
                              int(pixel / 8) + 1};
      const auto part = renderer->Render({{}, rect, {piece}}, pool);
      ASSERT_TRUE(part.ok());
      Moments moments;
      moments.count = piece.Count() * kReplicates;
      for (int r = 0; r < kReplicates; ++r)
        moments.mean += part->values[layout.Mean(r, 1)] / kReplicates;
      moments.m2 = part->values[layout.M2(1)];
      moments.m3 = part->values[layout.M3(1)];
      merged.Merge(moments);
    }
    const double* values = &whole->values[pixel * layout.Doubles()];
    const double scale = values[layout.M2(1)] + 1e-30;
    EXPECT_NEAR(merged.mean, PixelMean(*whole, pixel, 1), 1e-13);
    EXPECT_NEAR(merged.m2 / scale, values[layout.M2(1)] / scale, 1e-11);
    EXPECT_NEAR(merged.m3 / scale, values[layout.M3(1)] / scale, 1e-9);
  }
}

TEST(UnitTest, RangesMayDifferFromPixelToPixel) {
  const JobSpec spec = TestSpec(2, 64, 4);
  const auto renderer = MakeRenderer(spec);
  RenderPool pool(2);
  const auto partial = renderer->Render({{}, spec.crop, {{0, 1}, {0, 2}, {4, 4}, {8, 16}}}, pool);
  ASSERT_TRUE(partial.ok()) << partial.status();
  EXPECT_EQ(partial->samples, (std::vector<uint32_t>{1, 2, 0, 8}));
  EXPECT_EQ(partial->rays[2], 0u);
}

TEST(UnitTest, RefusesPixelsOutsideTheFrameAndWrongCountsOfRanges) {
  const JobSpec spec = TestSpec(8, 64, 4);
  const auto renderer = MakeRenderer(spec);
  RenderPool pool(1);
  EXPECT_EQ(renderer->Render({{}, {0, 0, 9, 8}, {{0, 1}}}, pool).status().code(),
            absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(renderer->Render({{}, {0, 0, 8, 8}, {{0, 1}, {0, 1}}}, pool).status().code(),
            absl::StatusCode::kInvalidArgument);
}

TEST(UnitTest, StopsWhenCancelled) {
  const JobSpec spec = TestSpec(8, 64, 4);
  RenderPool pool(2);
  std::atomic<bool> cancel = true;
  EXPECT_EQ(MakeRenderer(spec)->Render({{}, spec.crop, {{0, 8}}}, pool, &cancel).status().code(),
            absl::StatusCode::kCancelled);
}

TEST(TracedDigestTest, IsTheSameEachTime) {
  const Digest digest = TracedDigest();
  EXPECT_EQ(digest, TracedDigest());
  EXPECT_NE(digest, Digest{});
}

/// Of the processor's approximate reciprocals and reciprocal roots, the one thing of Embree's code
/// that vendors are free to choose.
Digest ApproximateReciprocals() {
  std::vector<float> found;
  for (uint32_t i = 0; i < 1u << 16; ++i) {
    const __m128 x = _mm_set_ss(std::bit_cast<float>(0x3f800000u + (i << 7)));  // In [1, 2).
    found.push_back(_mm_cvtss_f32(_mm_rcp_ss(x)));
    found.push_back(_mm_cvtss_f32(_mm_rsqrt_ss(x)));
    found.push_back(_mm_cvtss_f32(_mm_rsqrt_ss(_mm_add_ss(x, x))));
  }
  Sha256 sha;
  sha.Update(std::as_bytes(std::span(found)));
  return sha.Finish();
}

// What gcc's code for AVX2 and for AVX-512 computes, and clang's.
TEST(TracedDigestTest, IsThatOfTheKernelRevision) {
  const std::string reciprocals = ApproximateReciprocals().ToString();
  if (LibraryVersions()["embree"] != "3.13.5" ||
      reciprocals != "sha256:a35bde433a962fb83c14a6bb2da192b6afad37a22a9c12ced86917ded0467d98") {
    GTEST_SKIP() << "known are the bits of Embree 3.13.5 on AMD's Zen 4; its version or the "
                    "processor's approximate reciprocals are others here: "
                 << reciprocals;
  }
  EXPECT_EQ(kKernelRevision, 17u);
  EXPECT_EQ(TracedDigest().ToString(),
            "sha256:15bf9feac6e14263d82587859e82a009c7a17c3943b6abde11f093db75d5d2f7")
      << "If the kernels were changed, raise kKernelRevision and note both here; if not, this "
         "compiler or this processor computes other bits.";
}

}  // namespace
}  // namespace strata
