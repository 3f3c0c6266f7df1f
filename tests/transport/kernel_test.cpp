#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

#include "tests/all_samplers.h"
#include "tests/pbrt/scene_folder.h"
#include "tests/transport/kernels.h"
#include "tests/transport/test_scene.h"

// The fast kernel against the reference kernel: from the same random numbers nearly every sample is
// the same, and where roundings send a path another way, the means are.

namespace strata {
namespace {

/// One of each: surfaces that are traced side by side and those that are not, and every light.
TestScene OneOfEach() {
  TestScene scene;
  const TextureId half = scene.Texture(Rgb::Gray(0.5f)), rough = scene.Texture(Rgb::Gray(0.2f));
  const Roughness alpha = {.u = rough, .v = scene.Texture(Rgb::Gray(0.4f)), .remap = false};
  scene.description.textures.push_back(
      CheckerboardTexture{.a = half, .b = rough, .mapping = {4, 4}});
  const TextureId checkerboard = static_cast<TextureId>(scene.description.textures.size()) - 1;
  const MaterialId black = scene.Diffuse(0.0f);

  TriangleMeshShape floor;
  floor.positions = {{-4, 0, -4}, {-4, 0, 4}, {4, 0, 4}, {4, 0, -4}};
  floor.normals = {{0.1f, 1, 0}, {0, 1, 0.1f}, {-0.1f, 1, 0}, {0, 1, -0.1f}};
  floor.uvs = {{0, 0}, {0, 1}, {1, 1}, {1, 0}};
  floor.triangles = {{0, 1, 2}, {0, 2, 3}};
  ShapeDescription& shape = scene.description.shapes.emplace_back();
  shape.geometry = floor;
  shape.material = scene.Material(DiffuseMaterial{checkerboard});

  scene.Polygon({{-4, 0, 4}, {-4, 4, 4}, {4, 4, 4}, {4, 0, 4}}, scene.Diffuse({0.7f, 0.5f, 0.3f}));
  scene.Polygon({{-1, 3.5f, 0}, {1, 3.5f, 0}, {1, 3.5f, 1}, {-1, 3.5f, 1}}, black, Emits(6, true));
  scene.Polygon({{-3, 0.1f, 3}, {-2, 0.1f, 3}, {-2.5f, 2, 3}}, black, Emits(3, true));
  scene.Sphere({2, 2, 2}, 0.4f, black, Emits(5));
  const MaterialId brass = scene.Material(ConductorMaterial{
      .reflectance = half,
      .roughness = {.u = scene.Texture(Rgb::Gray(0.1f)), .v = rough, .remap = false}});
  scene.Polygon({{-3.9f, 0, -4}, {-3.9f, 4, -4}, {-3.9f, 4, 3}, {-3.9f, 0, 3}}, brass);
  float x = -2.4f;
  for (const MaterialDescription& material : {
           MaterialDescription(ConductorMaterial{.reflectance = half, .roughness = alpha}),
           MaterialDescription(DielectricMaterial{.eta = 1.5f}),
           MaterialDescription(CoatedDiffuseMaterial{
               .reflectance = checkerboard, .roughness = alpha, .albedo = scene.Texture({})}),
           MaterialDescription(DiffuseTransmissionMaterial{half, rough}),
           MaterialDescription(MetallicRoughnessMaterial{.base_color = checkerboard,
           .metallic = rough,
           .roughness = half,
           .transmission = half,
           .coat = half}),
       }) {
    scene.Sphere({x, 0.7f, 0}, 0.6f, scene.Material(material));
    x += 1.3f;
  }
  // Mapped normals on a wall and a ball; a screen and a ball of which a part is there.
  scene.description.textures.push_back(CheckerboardTexture{.a = scene.Texture({0.6f, 0.4f, 0.9f}),
                                                           .b = scene.Texture({0.5f, 0.6f, 0.95f}),
                                                           .mapping = {9, 9}});
  const TextureId normals = static_cast<TextureId>(scene.description.textures.size()) - 1;
  const auto mapped = [&](const MaterialDescription& description) {
    const MaterialId material = scene.Material(description);
    scene.description.surface_details[material] = {.normal_map = normals};
    return material;
  };
  scene.Polygon({{3.9f, 0, 3}, {3.9f, 4, 3}, {3.9f, 4, -4}, {3.9f, 0, -4}},
                mapped(DiffuseMaterial{half}));
  scene.Sphere({0, 0.3f, -1.5f}, 0.3f,
               mapped(ConductorMaterial{.reflectance = half, .roughness = alpha}));
  scene.Polygon({{-1, 0.1f, -1.2f}, {1, 0.1f, -1.2f}, {1, 1, -1.2f}, {-1, 1, -1.2f}},
                scene.Diffuse(0.4f));
  scene.description.shapes.back().alpha.texture = half;
  scene.Sphere({1.2f, 0.3f, -1.5f}, 0.3f, scene.Diffuse(0.5f));
  scene.description.shapes.back().alpha.texture = checkerboard;
  // A sum of lobes, one of them textured, on a ball.
  const TextureId exponent = scene.Texture(Rgb::Gray(30));
  scene.Sphere(
      {-1.2f, 0.3f, -1.5f}, 0.3f,
      scene.Material(MixMaterial{
          .a = scene.Material(BlinnMaterial{.reflectance = half, .exponent = exponent}),
          .b = scene.Material(AshikhminShirleyMaterial{checkerboard, rough, exponent, half}),
          .amount = half,
          .sum = true}));
  ObjectDescription& object = scene.description.objects.emplace_back();
  ShapeDescription& part = object.shapes.emplace_back();
  part.geometry = floor;
  part.material = scene.Diffuse(0.6f);
  scene.description.instances.emplace_back().to_world =
      Transform::Translate(-3, 1, 1) * Transform::Rotate(70, 0, 0, 1) * Transform::Scale(.3, 1, .3);
  scene.Light(PointLightDescription{{-2, 3, -2}, {2, 2, 2}});
  scene.Light(DistantLightDescription{{0, 0.8f, -0.6f}, {0.5f, 0.5f, 0.4f}});
  scene.Light(ConstantInfiniteLightDescription{{0.2f, 0.3f, 0.4f}});
  scene.Camera({0, 2, -5}, {0, 0.9f, 1}, 50);
  scene.description.camera.lens_radius = 0.05f;
  scene.description.camera.focal_distance = 5;
  return scene;
}

TEST(KernelTest, NearlyEverySampleIsTheSame) {
  const auto scene = BuildScene(OneOfEach());
  ASSERT_FALSE(scene->lamp_images().empty());
  JobSpec spec = TestSpec(48, 64, 12);
  for (const SamplerKind sampler : kAllSamplers) {
    spec.sampler = sampler;
    EXPECT_GE(AgreeingShare(scene, spec, 1e-5), 0.999) << ToString(sampler);
    spec.spp = 16;  // That is enough for the others.
  }
}

TEST(KernelTest, NearlyEverySampleIsTheSameWithAnyRoulette) {
  const auto scene = BuildScene(OneOfEach());
  JobSpec spec = TestSpec(48, 16, 12);
  for (const RouletteKind roulette : {RouletteKind::kOff, RouletteKind::kEfficiency}) {
    spec.roulette = roulette;
    EXPECT_GE(AgreeingShare(scene, spec, 1e-5), 0.999) << ToString(roulette);
  }
}

/// A room of flat walls; with a ball of metal and a second lamp it needs more of the kernel.
TestScene Room(bool plain) {
  TestScene scene;
  const MaterialId wall = scene.Diffuse({0.7f, 0.5f, 0.3f}), black = scene.Diffuse(0.0f);
  scene.Polygon({{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}, wall);
  scene.Polygon({{-2, 0, 2}, {-2, 3, 2}, {2, 3, 2}, {2, 0, 2}}, wall);
  scene.Polygon({{-0.5f, 2.9f, 0}, {0.5f, 2.9f, 0}, {0.5f, 2.9f, 1}, {-0.5f, 2.9f, 1}}, black,
                Emits(6, true));
  scene.Camera({0, 1.5f, -4}, {0, 1, 0}, 50);
  if (plain) return scene;
  scene.Sphere({0.5f, 0.5f, 0.5f}, 0.5f,
               scene.Material(ConductorMaterial{.reflectance = scene.Texture(Rgb::Gray(0.7f))}));
  scene.Polygon({{-2, 1, 0}, {-2, 2, 0}, {-2, 2, 1}, {-2, 1, 1}}, black, Emits(2, true));
  return scene;
}

/// A room of papered and varnished surfaces.
TestScene VarnishedRoom() {
  TestScene scene = Room(false);
  ImageFile picture = {.width = 16, .height = 16, .channels = 3, .eight_bit = true};
  for (int i = 0; i < 16 * 16 * 3; ++i)
    picture.values.push_back(static_cast<float>(37 * i % 256) / 255);
  scene.description.textures.push_back(
      ImageTexture{.path = "picture",
                   .mapping = {3, 2},
                   .embedded = std::make_shared<const EmbeddedImage>(std::move(picture))});
  const TextureId image = static_cast<TextureId>(scene.description.textures.size()) - 1;
  const TextureId gray = scene.Texture(Rgb::Gray(0.6f));
  const auto coated = [&](TextureId reflectance, float alpha, float thickness) {
    const TextureId roughness = scene.Texture(Rgb::Gray(alpha));
    return scene.Material(
        CoatedDiffuseMaterial{.reflectance = reflectance,
                              .roughness = {.u = roughness, .v = roughness, .remap = false},
                              .thickness = thickness});
  };
  scene.description.shapes[0].material = coated(image, 0.01f, 0.01f);
  scene.description.shapes[1].material = scene.Material(DiffuseMaterial{image});
  scene.Sphere({-1, 0.5f, 0.5f}, 0.5f, coated(image, 0, 0.3f));
  scene.Sphere({-0.3f, 0.3f, -0.5f}, 0.3f, coated(gray, 0.2f, 0));
  scene.Sphere({1.3f, 0.3f, -0.3f}, 0.3f, coated(gray, 0, 0.01f));
  return scene;
}

TEST(KernelTest, TheSmallestKernelGivesTheBitsOfAnyOther) {
  const JobSpec spec = TestSpec(32, 16, 8);
  const DirectorySource source(".");
  uint32_t last = kAllFeatures + 1;
  for (const TestScene& scene : {OneOfEach(), VarnishedRoom(), Room(true)}) {
    const auto least = BuildScene(scene);
    EXPECT_LT(least->features(), last);
    last = least->features();
    const auto any = BuildScene(scene, source, {.least_kernel = false});
    EXPECT_EQ(any->features(), kAllFeatures);
    EXPECT_EQ(RenderFrame(least, spec).values, RenderFrame(any, spec).values);
  }
  EXPECT_EQ(last, kNoFeatures);
}

TEST(KernelTest, VarnishedSurfacesAgree) {
  const auto scene = BuildScene(VarnishedRoom());
  ASSERT_TRUE(scene->materials().has_base_textures());
  ASSERT_TRUE(scene->lamp_images().empty());
  JobSpec spec = TestSpec(48, 64, 12);
  EXPECT_GE(AgreeingShare(scene, spec, 1e-5), 0.999);
  spec.channels.albedo = spec.channels.normal = true;
  EXPECT_GE(AgreeingShare(scene, spec, 1e-5), 0.999);
}

TEST(KernelTest, BothCountReflectancesThatAreNoNumbers) {
  TestScene scene = Room(false);
  const auto add = [&](const TextureDescription& texture) {
    scene.description.textures.push_back(texture);
    return static_cast<TextureId>(scene.description.textures.size()) - 1;
  };
  // Half of the cells are infinite; twice that less that is no number.
  const TextureId cells = add(CheckerboardTexture{.a = scene.Texture(Rgb::Gray(0.5f)),
                                                  .b = scene.Texture(Rgb::Gray(3e38f)),
                                                  .mapping = {4, 4}});
  const TextureId infinite = add(ScaleTexture{cells, scene.Texture(Rgb::Gray(100))});
  const TextureId none = add(MixTexture{infinite, infinite, scene.Texture(Rgb::Gray(2))});
  scene.description.shapes[0].material = scene.Material(DiffuseMaterial{none});
  const auto built = BuildScene(scene);
  const JobSpec spec = TestSpec(16, 8, 3);
  const auto defects = [&](KernelKind kernel) {
    uint64_t sum = 0;
    for (const uint32_t n : RenderBy(built, spec, kernel, {0, 1}).nonfinite) sum += n;
    return sum;
  };
  EXPECT_GT(defects(KernelKind::kFast), 0u);
  EXPECT_EQ(defects(KernelKind::kFast), defects(KernelKind::kReference));
}

TEST(KernelTest, SmallScenesAgreeWithTheirHierarchy) {
  const TestScene room = Room(true);
  const JobSpec spec = TestSpec(48, 64, 8);
  EXPECT_GE(AgreeingShare(BuildScene(room), spec, 1e-5), 0.999);
  EXPECT_GE(
      AgreeingShare(BuildScene(room, DirectorySource("."), {.few_triangles = false}), spec, 1e-5),
      0.999);
}

TEST(KernelTest, LampsMayBeTextured) {
  TestScene scene = OneOfEach();
  scene.description.textures.push_back(
      CheckerboardTexture{scene.Texture(Rgb::Gray(0.1f)), scene.Texture(Rgb::Gray(2)), {5, 3}});
  const TextureId cells = static_cast<TextureId>(scene.description.textures.size()) - 1;
  for (ShapeDescription& shape : scene.description.shapes) {
    if (shape.emission) shape.emission->texture = cells;
  }
  EXPECT_GE(AgreeingShare(BuildScene(scene), TestSpec(48, 64, 12), 1e-5), 0.999);
}

TEST(KernelTest, LightsMayTakeFiles) {
  const SceneFolder folder;
  folder.Write("lamp.ies", "TILT=NONE\n1 -1 1 3 1 1 2 0 0 0 1 1 9\n0 60 120\n0\n9 7 1\n");
  std::string slide = "PF\n2 2\n-1.0\n";
  for (const float value : {1, 2, 3, 4, 5, 6, 7, 8, 9, 1, 2, 3})
    slide.append(reinterpret_cast<const char*>(&value), sizeof(value));
  folder.Write("slide.pfm", slide);
  TestScene scene = OneOfEach();
  scene.Light(
      SpotLightDescription{{1, 3, -1}, Normalize(Vec3f{-0.3f, -1, 0.4f}), 40, 10, {9, 8, 7}});
  scene.Light(ProjectionLightDescription{
      "slide.pfm", *Transform::LookAt({2, 3, -3}, {0, 0, 1}, {0, 1, 0})->Inverse(), 40, 0.5f, {}});
  scene.Light(GoniometricLightDescription{
      "lamp.ies", Transform::Translate(0, 3, 2), {0.3f, 0.2f, 0.1f}, {}});
  ImageInfiniteLightDescription sky;
  sky.path = "slide.pfm";
  sky.portal = {Vec3d{-2, 2, 2}, {-2, 4, 2}, {2, 4, 2}, {2, 2, 2}};
  scene.Light(sky);
  const auto built = BuildScene(scene, DirectorySource(folder.root()));
  EXPECT_GE(AgreeingShare(built, TestSpec(48, 64, 12), 1e-5), 0.999);
}

TEST(KernelTest, ChannelsAreTheSame) {
  const auto scene = BuildScene(OneOfEach());
  JobSpec spec = TestSpec(32, 32, 3);
  spec.channels = {.alpha = true, .albedo = true, .normal = true, .depth = true};
  const Partial fast = RenderBy(scene, spec, KernelKind::kFast, {0, 4});
  const Partial plain = RenderBy(scene, spec, KernelKind::kReference, {0, 4});
  int differing = 0;
  for (int64_t pixel = 0; pixel < spec.crop.Pixels(); ++pixel) {
    for (int i = 0; i < fast.layout.plain; ++i) {
      const int64_t at = pixel * fast.layout.Doubles() + fast.layout.Plain(i);
      differing += std::abs(fast.values[at] - plain.values[at]) > 1e-4;
    }
  }
  EXPECT_LE(differing, 2);
}

/// With other seeds, so that nothing is shared; the control is one of them with 3 % added.
TEST(KernelTest, MeansAgree) {
  const auto scene = BuildScene(OneOfEach());
  JobSpec spec = TestSpec(24, 512, 12);
  const Estimate fast = FrameMean(RenderBy(scene, spec, KernelKind::kFast, {0, 64}), 1);
  spec.seed = 8;
  const Estimate plain = FrameMean(RenderBy(scene, spec, KernelKind::kReference, {0, 64}), 1);
  EXPECT_TRUE(Agree(fast, plain)) << fast.mean << " +- " << fast.standard_error << ", reference "
                                  << plain.mean << " +- " << plain.standard_error;
  EXPECT_FALSE(Agree({fast.mean * 1.03, fast.standard_error}, plain));
}

TEST(KernelTest, SharedScenesAgree) {
  const char* shared = std::getenv("STRATA_SHARED");
  const std::filesystem::path root =
      shared ? shared : std::filesystem::path(STRATA_SOURCE_DIR) / ".." / "shared";
  for (const std::string name : {"cornell-box", "veach-bidir", "veach-mis", "coffee"}) {
    const std::filesystem::path folder = root / "scenes" / "pbrt" / name;
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is missing";
    const auto scene = LoadScene(DirectorySource(folder), "scene.pbrt");
    ASSERT_TRUE(scene.ok()) << scene.status();
    const double share =
        AgreeingShare(*scene, TestSpec(64, 64, (*scene)->defaults().max_depth), 1e-5);
    EXPECT_GE(share, 0.999) << name;
    std::printf("%s: %.6f of the samples agree within 1e-5\n", name.c_str(), share);
  }
}

}  // namespace
}  // namespace strata
