#include <gtest/gtest.h>

#include <cstring>

#include "tests/pbrt/scene_folder.h"
#include "tests/transport/test_scene.h"

// Pixels whose rays surely meet nothing are not traced, and no bit of the picture shows it.

namespace strata {
namespace {

/// A ball of 0.3 off the middle of the picture, under a sky if there is a source of images.
TestScene Ball(bool sky) {
  TestScene scene;
  scene.Sphere({0.4f, 0.2f, 0}, 0.3f, scene.Diffuse({0.8f, 0.5f, 0.2f}));
  if (sky) {
    ImageInfiniteLightDescription image;
    image.path = "sky.pfm";
    scene.Light(image);
  } else {
    scene.Light(DistantLightDescription{{0, 0.8f, -0.6f}, {0.5f, 0.5f, 0.4f}});
  }
  scene.Camera({0.1f, 0.3f, -5}, {0, 0, 0}, 40);
  return scene;
}

struct Case {
  const char* name;
  bool sky;
  void (*change)(TestScene&, JobSpec&);
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }

class Background : public testing::TestWithParam<Case> {};

TEST_P(Background, IsTheSameWhetherTracedOrNot) {
  const SceneFolder folder;
  std::string sky = "PF\n8 8\n-1.0\n";
  for (int i = 0; i < 8 * 8 * 3; ++i) {
    const float value = 0.1f + 0.01f * static_cast<float>(i * 37 % 101);
    sky.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  folder.Write("sky.pfm", sky);
  const DirectorySource source(folder.root());
  TestScene scene = Ball(GetParam().sky);
  JobSpec spec = TestSpec(48, 16, 3);
  spec.channels = {.alpha = true, .albedo = true, .normal = true, .depth = true};
  GetParam().change(scene, spec);
  const auto skipping = BuildScene(scene, source);
  const auto tracing = BuildScene(scene, source, {.skip_background = false});
  const auto pixels = [&](const std::shared_ptr<const Scene>& of) {
    return (*Renderer::Create(of, spec))->BackgroundPixels();
  };
  EXPECT_EQ(pixels(tracing), 0);
  // The ball's box is seen in less than a seventh of the picture, blurred or not.
  EXPECT_GT(pixels(skipping), 48 * 48 * 3 / 4);
  for (const KernelKind kernel : {KernelKind::kFast, KernelKind::kReference}) {
    spec.kernel = kernel;
    const Partial skipped = RenderFrame(skipping, spec);
    const Partial traced = RenderFrame(tracing, spec);
    ASSERT_EQ(skipped.values.size(), traced.values.size());
    EXPECT_EQ(std::memcmp(skipped.values.data(), traced.values.data(),
                          traced.values.size() * sizeof(double)),
              0);
    EXPECT_EQ(skipped.rays, traced.rays);
    EXPECT_EQ(skipped.samples, traced.samples);
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, Background,
    testing::Values(Case{"Plain", false, [](TestScene&, JobSpec&) {}},
                    Case{"UnderASky", true, [](TestScene&, JobSpec&) {}},
                    Case{"WideFilter", true,
                         [](TestScene&, JobSpec& spec) {
                           spec.filter = {
                               .kind = FilterKind::kGaussian, .radius_x = 2.5, .radius_y = 1.5};
                         }},
                    Case{"Lens", true,
                         [](TestScene& scene, JobSpec&) {
                           scene.description.camera.lens_radius = 0.1f;
                           scene.description.camera.focal_distance = 3;
                         }},
                    Case{"Orthographic", true,
                         [](TestScene& scene, JobSpec&) {
                           scene.description.camera.kind = CameraKind::kOrthographic;
                           scene.description.camera.screen_window = {-2, 2, -2, 2};
                           scene.description.camera.lens_radius = 0.1f;
                           scene.description.camera.focal_distance = 3;
                         }}),
    [](const auto& info) { return info.param.name; });

TEST(BackgroundBounds, HoldNoMoreThanTheyMust) {
  // The box of the ball, seen from five away: corners four and seven tenths away at the nearest.
  const JobSpec spec = TestSpec(400, 8, 1);
  TestScene scene = Ball(false);
  scene.Camera({0.4f, 0.2f, -5}, {0.4f, 0.2f, 0}, 90);
  const auto renderer = Renderer::Create(BuildScene(scene), spec);
  // 0.3 / 4.7 of 200 pixels to each side are 12.8, and there are two for the rounding and the rest.
  const double side = 2 * 12.77;
  const auto seen = static_cast<double>(400 * 400 - (*renderer)->BackgroundPixels());
  EXPECT_GE(seen, side * side);
  EXPECT_LE(seen, (side + 8) * (side + 8));
}

}  // namespace
}  // namespace strata
