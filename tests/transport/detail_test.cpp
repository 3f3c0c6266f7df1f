#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/transport/test_scene.h"

// Normal maps and alpha masks in the light of scenes with closed forms, by both kernels. Controls
// are those of ExpectMean.

namespace strata {
namespace {

constexpr double kPiDouble = std::numbers::pi;

/// A diffuse floor of reflectance 0.6, seen at the origin alone.
MaterialId Floor(TestScene* scene) {
  const MaterialId material = scene->Diffuse(0.6f);
  scene->Polygon({{-50, 0, -50}, {-50, 0, 50}, {50, 0, 50}, {50, 0, -50}}, material);
  scene->Camera({1, 2, 1}, {0, 0, 0}, 0.01f);
  return material;
}

void ExpectInBothKernels(const TestScene& scene, double truth, uint32_t spp) {
  const auto built = BuildScene(scene);
  JobSpec spec = TestSpec(16, spp, 1);
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    spec.kernel = kernel;
    ExpectMean(RenderFrame(built, spec), truth);
  }
}

TEST(NormalMapsInLight, TurnTheSurfaceTowardsTheLight) {
  TestScene scene;
  const MaterialId floor = Floor(&scene);
  const Vec3f light = Normalize(Vec3f{0.5f, 1, 0.2f});
  scene.Light(DistantLightDescription{light, Rgb::Gray(1)});
  // dp/du is along z in the one triangle, the normal along y: the frame is (z, x, y). In the other
  // dp/du is the diagonal, which the camera looks at: half of the frame shows each.
  scene.description.surface_details[floor] = {.normal_map = scene.Texture({0.6f, 0.8f, 0.9f})};
  const Vec3f n = Normalize(Vec3f{0.6f, 0.8f, 0.2f});
  const float half = std::sqrt(0.5f);
  const Vec3f other = Normalize(Vec3f{0.8f * half, 0.8f, -0.4f * half});
  ExpectInBothKernels(scene, 0.6 / kPiDouble * (Dot(n, light) + Dot(other, light)) / 2, 64);
}

TEST(NormalMapsInLight, LetNoLightThroughTheSurface) {
  TestScene scene;
  const MaterialId floor = Floor(&scene);
  // From below, but on the outer side of the turned normal.
  const Vec3f light = Normalize(Vec3f{1, -0.2f, 0});
  scene.Light(DistantLightDescription{light, Rgb::Gray(1)});
  scene.description.surface_details[floor] = {.normal_map = scene.Texture({0.5f, 0.95f, 0.6f})};
  ASSERT_GT(Dot(Vec3f{0.9f, 0.2f, 0}, light), 0);
  const auto built = BuildScene(scene);
  JobSpec spec = TestSpec(16, 64, 3);
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    spec.kernel = kernel;
    EXPECT_EQ(FrameMean(RenderFrame(built, spec), 1).mean, 0);
  }
}

TEST(AlphaMasksInLight, LetTheRestOfALampThrough) {
  TestScene scene;
  Floor(&scene);
  scene.Light(PointLightDescription{{0, 4, 0}, {2, 2, 2}});
  for (const float height : {1.0f, 2.0f}) {
    scene.Polygon({{-0.4f, height, -0.4f},
                   {-0.4f, height, 0.4f},
                   {0.4f, height, 0.4f},
                   {0.4f, height, -0.4f}},
                  0);
    scene.description.shapes.back().alpha.texture = scene.Texture(Rgb::Gray(0.3f));
  }
  ExpectInBothKernels(scene, 0.6 / kPiDouble * 2 / 16 * 0.7 * 0.7, 8192);
}

TEST(AlphaMasksInLight, LetTheRestOfTheSkyThrough) {
  // Found by scattered rays as well as by aimed ones.
  TestScene scene;
  Floor(&scene);
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(1)});
  scene.Sphere({0, 0, 0}, 0.3f, scene.Diffuse(0.0f));
  scene.description.shapes.back().alpha.texture = scene.Texture(Rgb::Gray(0.25f));
  // The camera's ray meets the sphere on its way in, and light meets it on its own way in.
  ExpectInBothKernels(scene, 0.6 * 0.75 * 0.75, 512);
}

/// The floor under a screen that emits, of which only a part is there.
Estimate UnderScreen(float radiance, std::optional<TextureDescription> alpha, bool other_light) {
  TestScene scene;
  Floor(&scene);
  scene.Polygon({{-1, 1, -1}, {1, 1, -1}, {1, 1, 1}, {-1, 1, 1}}, scene.Diffuse(0.0f),
                Emits(radiance));
  if (alpha) {
    scene.description.textures.push_back(*alpha);
    scene.description.shapes.back().alpha.texture =
        static_cast<TextureId>(scene.description.textures.size()) - 1;
  }
  if (other_light) scene.Light(DistantLightDescription{{0.6f, 0.8f, 0}, Rgb::Gray(0.5f)});
  scene.Camera({3, 0.5f, 0}, {0, 0, 0}, 0.01f);
  return FrameMean(RenderFrame(BuildScene(scene), TestSpec(16, 2048, 1)), 1);
}

TEST(AlphaMasksInLight, DimEmittersByWhatIsNotThere) {
  for (const bool other_light : {false, true}) {
    const Estimate masked = UnderScreen(8, ConstantTexture{Rgb::Gray(0.25f)}, other_light);
    // The sun shines through the part that is not there; aside of the screen it would do so always.
    const Estimate whole = UnderScreen(2, std::nullopt, false);
    const double sun = other_light ? 0.6 / kPiDouble * 0.5 * 0.8 * 0.75 : 0;
    const Estimate expected = {whole.mean + sun, whole.standard_error};
    EXPECT_TRUE(Agree(masked, expected))
        << masked.mean << " +- " << masked.standard_error << ", expected " << expected.mean
        << " +- " << expected.standard_error;
    EXPECT_FALSE(Agree({masked.mean * 1.02, masked.standard_error}, expected));
  }
}

}  // namespace
}  // namespace strata
