#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "tests/pbrt/scene_folder.h"
#include "tests/transport/kernels.h"
#include "tests/transport/test_scene.h"
#include "worker/sampling/mis.h"

// Light sampling alone, BSDF sampling alone, both under MIS, and directions drawn evenly or by
// their cosine are estimators of one number. Each is compared with MIS at p = 1e-5; the control is
// MIS with 3 % added, and with 12 % where lamps are found by directions that know of nothing.

namespace strata {
namespace {

using MakeMaterial = std::function<MaterialDescription(TestScene&)>;
enum class Sky { kConstant, kImage };

/// A sky with black parts, and a sun of 0.2 steradians that BSDF sampling finds, as a file of PFM.
std::string SkyWithSun() {
  constexpr int kSize = 16;
  std::string bytes = "PF\n16 16\n-1.0\n";
  for (int i = 0; i < kSize * kSize; ++i) {
    const int x = i % kSize, y = i / kSize;
    const bool sun = x / 2 == 4 && y / 2 == 2;
    const float radiance = sun ? 20 : x % 4 == 0 ? 0 : 0.3f;
    for (int channel = 0; channel < 3; ++channel)
      bytes.append(reinterpret_cast<const char*>(&radiance), sizeof(radiance));
  }
  return bytes;
}

/// A floor of the material and a wall, lit by a triangle, a sphere, a disk and the sky.
TestScene Studio(const MakeMaterial& make, Sky sky = Sky::kConstant) {
  TestScene scene;
  const MaterialId material = scene.Material(make(scene));
  const MaterialId black = scene.Diffuse(0.0f);
  scene.Polygon({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}}, material);
  scene.Polygon({{-3, 0, 3}, {-3, 4, 3}, {3, 4, 3}, {3, 0, 3}}, scene.Diffuse(0.6f));
  scene.Polygon({{-1, 3, 1}, {1, 3, 1}, {0, 3, 2.5f}}, black, Emits(6, true));
  scene.Sphere({1.5f, 1, 1}, 0.6f, black, Emits(2));
  ShapeDescription disk;
  disk.geometry = DiskShape{.radius = 0.8f};
  disk.to_world = Transform::Translate(-2, 1, 1) * Transform::Rotate(60, 0, 1, 0);
  disk.material = black;
  disk.emission = Emits(2, true);
  scene.description.shapes.push_back(disk);
  if (sky == Sky::kImage) {
    ImageInfiniteLightDescription image;
    image.path = "sky.pfm";
    image.to_world = Transform::Rotate(-90, 1, 0, 0);  // The image's z is up.
    scene.Light(image);
  } else {
    scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(0.5f)});
  }
  scene.Camera({0, 2, -4}, {0, 0.6f, 1}, 40);
  return scene;
}

void ExpectStrategiesAgree(const TestScene& scene) {
  const SceneFolder folder;
  folder.Write("sky.pfm", SkyWithSun());
  const DirectorySource source(folder.root());
  const auto built = BuildScene(scene, source);
  JobSpec spec = TestSpec(24, 512, 4);
  const Estimate mis = FrameMean(RenderFrame(built, spec), 1);
  for (const DirectStrategy strategy : {DirectStrategy::kLightOnly, DirectStrategy::kBsdfOnly,
                                        DirectStrategy::kCosine, DirectStrategy::kUniform}) {
    ++spec.seed;
    const Estimate single = FrameMean(RenderFrame(built, spec, strategy), 1);
    EXPECT_TRUE(Agree(mis, single))
        << mis.mean << " +- " << mis.standard_error << ", " << ToString(strategy) << " "
        << single.mean << " +- " << single.standard_error;
    const bool informed =
        strategy == DirectStrategy::kLightOnly || strategy == DirectStrategy::kBsdfOnly;
    EXPECT_FALSE(Agree({mis.mean * (informed ? 1.03 : 1.12), mis.standard_error}, single))
        << ToString(strategy) << ": " << single.standard_error;
  }
  for (const double beta : {0.0, kBalance, kMaxMisBeta}) {
    ++spec.seed;
    spec.mis_beta = beta;
    const Estimate weighted = FrameMean(RenderFrame(built, spec), 1);
    EXPECT_TRUE(Agree(mis, weighted))
        << mis.mean << " +- " << mis.standard_error << ", beta " << beta << " " << weighted.mean
        << " +- " << weighted.standard_error;
    EXPECT_FALSE(Agree({mis.mean * 1.03, mis.standard_error}, weighted)) << beta;
  }
}

MaterialDescription Matte(TestScene& scene) {
  return DiffuseMaterial{scene.Texture(Rgb::Gray(0.5f))};
}

Roughness Alpha(TestScene& scene, float alpha) {
  const TextureId texture = scene.Texture(Rgb::Gray(alpha));
  return {.u = texture, .v = texture, .remap = false};
}

MaterialDescription RoughMetal(TestScene& scene) {
  return ConductorMaterial{.reflectance = scene.Texture(Rgb::Gray(0.5f)),
                           .roughness = Alpha(scene, 0.2f)};
}

MaterialDescription Plastic(TestScene& scene) {
  return CoatedDiffuseMaterial{.reflectance = scene.Texture(Rgb::Gray(0.5f)),
                               .roughness = Alpha(scene, 0.3f),
                               .albedo = scene.Texture({})};
}

MaterialDescription Lacquer(TestScene& scene) {
  return CoatedConductorMaterial{.interface_roughness = Alpha(scene, 0.2f),
                                 .conductor_roughness = Alpha(scene, 0.4f),
                                 .reflectance = scene.Texture(Rgb::Gray(0.7f))};
}

MaterialDescription RoughGlass(TestScene& scene) {
  return DielectricMaterial{.eta = 1.5f, .roughness = Alpha(scene, 0.3f)};
}

MaterialDescription Paper(TestScene& scene) {
  return DiffuseTransmissionMaterial{scene.Texture(Rgb::Gray(0.3f)),
                                     scene.Texture(Rgb::Gray(0.5f))};
}

/// A part of its reflection is a delta function.
MaterialDescription Varnish(TestScene& scene) {
  return CoatedDiffuseMaterial{.reflectance = scene.Texture(Rgb::Gray(0.5f)),
                               .roughness = Alpha(scene, 0),
                               .albedo = scene.Texture({})};
}

MaterialDescription VarnishedMetal(TestScene& scene) {
  return CoatedConductorMaterial{.interface_roughness = Alpha(scene, 0),
                                 .conductor_roughness = Alpha(scene, 0.4f),
                                 .reflectance = scene.Texture(Rgb::Gray(0.7f))};
}

MaterialDescription Mirror(TestScene& scene) {
  return ConductorMaterial{.reflectance = scene.Texture(Rgb::Gray(0.8f))};
}

TEST(StrategyTest, AgreeOnDiffuseSurfaces) { ExpectStrategiesAgree(Studio(Matte)); }
TEST(StrategyTest, AgreeOnRoughMetal) { ExpectStrategiesAgree(Studio(RoughMetal)); }
TEST(StrategyTest, AgreeOnCoatedSurfaces) { ExpectStrategiesAgree(Studio(Plastic)); }
TEST(StrategyTest, AgreeOnCoatedMetal) { ExpectStrategiesAgree(Studio(Lacquer)); }
TEST(StrategyTest, AgreeThroughRoughGlass) { ExpectStrategiesAgree(Studio(RoughGlass)); }
TEST(StrategyTest, AgreeThroughPaper) { ExpectStrategiesAgree(Studio(Paper)); }

TEST(StrategyTest, AgreeOnSmoothCoats) { ExpectStrategiesAgree(Studio(Varnish)); }
TEST(StrategyTest, AgreeOnSmoothCoatsOverMetal) { ExpectStrategiesAgree(Studio(VarnishedMetal)); }
TEST(StrategyTest, AgreeOnMirrors) { ExpectStrategiesAgree(Studio(Mirror)); }

/// Lights that no direction meets are sampled by all.
TEST(StrategyTest, AgreeUnderPointAndDistantLights) {
  TestScene scene = Studio(Varnish);
  scene.Light(PointLightDescription{{-1, 2, -1}, {3, 3, 3}});
  scene.Light(DistantLightDescription{{0.3f, 0.8f, -0.5f}, {1, 1, 1}});
  ExpectStrategiesAgree(scene);
}

TEST(StrategyTest, AgreeUnderAnImageOfTheSky) {
  for (const auto& make : {Matte, RoughMetal, Lacquer, Paper})
    ExpectStrategiesAgree(Studio(make, Sky::kImage));
}

TEST(StrategyTest, AgreeUnderTexturedLamps) {
  TestScene scene = Studio(Matte);
  const TextureId dark = scene.Texture(Rgb::Gray(0.1f)), bright = scene.Texture(Rgb::Gray(2));
  scene.description.textures.push_back(CheckerboardTexture{dark, bright, {5, 3}});
  const TextureId cells = static_cast<TextureId>(scene.description.textures.size()) - 1;
  for (ShapeDescription& shape : scene.description.shapes) {
    if (shape.emission) shape.emission->texture = cells;
  }
  ExpectStrategiesAgree(scene);
}

/// Each way of choosing and sampling lights has the same expectation.
TEST(StrategyTest, LightTechniquesChangeNoMean) {
  const SceneFolder folder;
  folder.Write("sky.pfm", SkyWithSun());
  const DirectorySource source(folder.root());
  TestScene scene = Studio(Lacquer, Sky::kImage);
  const MaterialId black = scene.Diffuse(0.0f);
  // A rectangle near the wall, and one that faces away from most of the floor.
  scene.Polygon({{-1, 1, 2.5f}, {1, 1, 2.5f}, {1, 2, 2.5f}, {-1, 2, 2.5f}}, black, Emits(3, true));
  scene.Polygon({{2.5f, 0.1f, -1}, {2.5f, 0.1f, 1}, {2.9f, 1, 1}, {2.9f, 1, -1}}, black, Emits(3));
  const auto mean = [&](const BuildOptions& lights, uint64_t seed) {
    JobSpec spec = TestSpec(24, 512, 4);
    spec.seed = seed;
    return FrameMean(RenderFrame(BuildScene(scene, source, lights), spec), 1);
  };
  const Estimate shipped = mean({}, 20);
  uint64_t seed = 20;
  for (const BuildOptions& lights :
       {BuildOptions{.selection = LightSelection::kIntensity},
        BuildOptions{.selection = LightSelection::kUniform}, BuildOptions{.quads = false},
        BuildOptions{.solid_angle = false}, BuildOptions{.sphere_cones = false},
        BuildOptions{.compensate = false}}) {
    const Estimate other = mean(lights, ++seed);
    EXPECT_TRUE(Agree(shipped, other))
        << seed << ": " << shipped.mean << " +- " << shipped.standard_error << ", " << other.mean
        << " +- " << other.standard_error;
    EXPECT_FALSE(Agree({shipped.mean * 1.03, shipped.standard_error}, other));
  }
}

TEST(StrategyTest, RoutinesChangeNoMean) {
  TestScene scene = Studio(Matte);
  // A triangle that is near the wall.
  scene.Polygon({{-1, 1, 2.8f}, {1, 1, 2.8f}, {0, 2, 2.8f}}, scene.Diffuse(0.0f), Emits(3, true));
  scene.description.camera.lens_radius = 0.2f;
  scene.description.camera.focal_distance = 4;
  const auto built = BuildScene(scene);
  JobSpec spec = TestSpec(24, 512, 4);
  for (const DirectStrategy strategy :
       {DirectStrategy::kMis, DirectStrategy::kCosine, DirectStrategy::kUniform}) {
    spec.routines = SamplingRoutines::kPreserving;
    const Estimate shipped = FrameMean(RenderFrame(built, spec, strategy), 1);
    for (const SamplingRoutines routines :
         {SamplingRoutines::kPlain, SamplingRoutines::kRejection}) {
      ++spec.seed;
      spec.routines = routines;
      const Estimate other = FrameMean(RenderFrame(built, spec, strategy), 1);
      EXPECT_TRUE(Agree(shipped, other))
          << ToString(strategy) << ", " << ToString(routines) << ": " << shipped.mean << " +- "
          << shipped.standard_error << ", " << other.mean << " +- " << other.standard_error;
      const double detectable = strategy == DirectStrategy::kMis ? 1.03 : 1.12;
      EXPECT_FALSE(Agree({shipped.mean * detectable, shipped.standard_error}, other));
    }
  }
}

/// A room with a window, and light from the sky through it.
TestScene RoomWithWindow(bool portal) {
  TestScene scene;
  const MaterialId wall = scene.Diffuse(0.6f);
  scene.Polygon({{-2, 0, -3}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -3}}, wall);
  scene.Polygon({{-2, 3, -3}, {2, 3, -3}, {2, 3, 2}, {-2, 3, 2}}, wall);
  scene.Polygon({{-2, 0, -3}, {-2, 3, -3}, {-2, 3, 2}, {-2, 0, 2}}, wall);
  scene.Polygon({{2, 0, -3}, {2, 0, 2}, {2, 3, 2}, {2, 3, -3}}, wall);
  scene.Polygon({{-2, 0, -3}, {2, 0, -3}, {2, 3, -3}, {-2, 3, -3}}, wall);
  scene.Polygon({{-2, 0, 2}, {-2, 3, 2}, {-0.6f, 3, 2}, {-0.6f, 0, 2}}, wall);
  scene.Polygon({{0.6f, 0, 2}, {0.6f, 3, 2}, {2, 3, 2}, {2, 0, 2}}, wall);
  scene.Polygon({{-0.6f, 0, 2}, {-0.6f, 1, 2}, {0.6f, 1, 2}, {0.6f, 0, 2}}, wall);
  scene.Polygon({{-0.6f, 2, 2}, {-0.6f, 3, 2}, {0.6f, 3, 2}, {0.6f, 2, 2}}, wall);
  ImageInfiniteLightDescription sky;
  sky.path = "sky.pfm";
  sky.to_world = Transform::Rotate(-90, 1, 0, 0);
  if (portal) sky.portal = {Vec3d{-0.6, 1, 2}, {-0.6, 2, 2}, {0.6, 2, 2}, {0.6, 1, 2}};
  scene.Light(sky);
  scene.Camera({1.5f, 1.5f, -2.5f}, {-0.5f, 0.8f, 1}, 60);
  return scene;
}

/// A portal where nothing else lets light in leaves out nothing, and light that no wall hides is
/// found more often.
TEST(StrategyTest, PortalsOfARoomChangeNoMean) {
  const SceneFolder folder;
  folder.Write("sky.pfm", SkyWithSun());
  const DirectorySource source(folder.root());
  const auto mean = [&](bool portal, DirectStrategy direct, uint64_t seed) {
    JobSpec spec = TestSpec(24, 1024, 4);
    spec.seed = seed;
    return FrameMean(RenderFrame(BuildScene(RoomWithWindow(portal), source), spec, direct), 1);
  };
  const Estimate with = mean(true, DirectStrategy::kMis, 40);
  const Estimate without = mean(false, DirectStrategy::kMis, 41);
  const Estimate light = mean(true, DirectStrategy::kLightOnly, 42);
  for (const Estimate& other : {without, light}) {
    EXPECT_TRUE(Agree(with, other)) << with.mean << " +- " << with.standard_error << ", "
                                    << other.mean << " +- " << other.standard_error;
    EXPECT_FALSE(Agree({with.mean * 1.05, with.standard_error}, other));
  }
  EXPECT_LT(with.standard_error, 0.6 * without.standard_error);
}

/// So have paths with and without a guide to lamps in mirrors.
TEST(StrategyTest, GuidesToMirrorsChangeNoMean) {
  for (const float alpha : {0.0f, 0.05f}) {
    TestScene scene;
    const MaterialId metal = scene.Material(ConductorMaterial{
        .reflectance = scene.Texture(Rgb::Gray(0.8f)), .roughness = Alpha(scene, alpha)});
    const TextureId half = scene.Texture(Rgb::Gray(0.5f));
    scene.Polygon({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}}, scene.Diffuse(0.6f));
    scene.Polygon(
        {{2, 0, -3}, {2, 0, 3}, {2, 3, 3}, {2, 3, -3}},
        scene.Material(CoatedDiffuseMaterial{
            .reflectance = half, .roughness = Alpha(scene, 0.3f), .albedo = scene.Texture({})}));
    scene.Polygon({{-2, 0.2f, 1}, {-2, 2, 1}, {-0.5f, 2, 2}, {-0.5f, 0.2f, 2}}, metal);
    scene.Sphere({0, 1.5f, -1}, 0.1f, scene.Diffuse(0.0f), Emits(80));
    // Keeps the lamp's own light off most of the floor.
    scene.Polygon({{-1, 1, -2}, {1, 1, -2}, {1, 1, 0}, {-1, 1, 0}}, scene.Diffuse(0.3f));
    scene.Camera({0, 0.9f, -2.9f}, {0, -0.3f, 0.5f}, 60);
    const auto mean = [&](bool mirrors, uint64_t seed) {
      JobSpec spec = TestSpec(24, 4096, 5);
      spec.seed = seed;
      const auto built = BuildScene(scene, DirectorySource("."), {.mirrors = mirrors});
      EXPECT_EQ(built->lamp_images().empty(), !mirrors);
      return FrameMean(RenderFrame(built, spec), 1);
    };
    const Estimate with = mean(true, 30), without = mean(false, 31);
    EXPECT_TRUE(Agree(with, without)) << alpha << ": " << with.mean << " +- " << with.standard_error
                                      << ", " << without.mean << " +- " << without.standard_error;
    // Without the guide little is known of a mirror's light.
    const double control = alpha == 0 ? 1.15 : 1.03;
    EXPECT_FALSE(Agree({with.mean * control, with.standard_error}, without));
    EXPECT_LT(with.standard_error, 0.7 * without.standard_error);
  }
}

TEST(StrategyTest, AgreeInsideASphereLight) {
  TestScene scene;
  scene.Sphere({0.2f, 0.1f, 0}, 1, scene.Diffuse(0.4f), Emits(1, true), true);
  scene.Sphere({0, 0, 0.3f}, 0.2f, scene.Diffuse(0.7f));
  scene.Camera({0, 0, -0.6f}, {0, 0, 1}, 60);
  ExpectStrategiesAgree(scene);
}

/// A ball of glass in fog over a floor, nearer than its focus, under a lamp 2 `half` wide, of one
/// power. The camera sees the floor alone.
TestScene BallUnderALamp(float half) {
  TestScene scene;
  const MaterialId black = scene.Diffuse(0.0f);
  scene.Polygon({{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}, {1, 0, -1}}, scene.Diffuse(0.5f));
  scene.Polygon({{-half, 3, -half}, {half, 3, -half}, {half, 3, half}, {-half, 3, half}}, black,
                Emits(1 / (half * half)));
  scene.Sphere({0.2f, 0.45f, 0}, 0.4f, scene.Material(DielectricMaterial{.eta = 1.5f}));
  scene.description.media.push_back({.scattering = Rgb::Gray(0.5f), .g = 0.3f});
  scene.description.shapes.back().border = MediumBorder{kNoMedium, 0};
  scene.description.camera.medium = 0;
  scene.Camera({0.2f, 0.25f, -1}, {0.2f, 0, -0.1f}, 50);
  return scene;
}

TEST(StrategyTest, BallsGuideWhereTheyGatherMostOfTheLight) {
  const auto images = [](float half, int balls, bool smooth) {
    TestScene scene = BallUnderALamp(half);
    DielectricMaterial glass = {.eta = 1.5f};
    if (!smooth) glass.roughness = {.u = scene.Texture(Rgb::Gray(0.2f)), .remap = false};
    for (int i = 0; i < balls; ++i)
      scene.Sphere({-4 + static_cast<float>(i), 0.4f, 3}, 0.4f, scene.Material(glass));
    return BuildScene(scene)->lamp_images().balls.images().size();
  };
  EXPECT_EQ(images(0.1f, 0, true), 1u);
  EXPECT_EQ(images(0.1f, 2, true), 3u);
  EXPECT_EQ(images(0.1f, 2, false), 1u) << "rough glass";
  EXPECT_EQ(images(0.1f, 20, true), 0u) << "too many";
  EXPECT_EQ(images(0.5f, 0, true), 0u) << "the lamp is large";
}

TEST(StrategyTest, BallsOfGlassGuideWithoutABias) {
  const auto mean = [](const TestScene& scene, bool balls, int spp) {
    const auto built = BuildScene(scene, DirectorySource("."), {.balls = balls});
    EXPECT_EQ(built->lamp_images().balls.empty(), !balls);
    JobSpec spec = TestSpec(16, spp, 5);
    spec.seed = balls;
    return FrameMean(RenderFrame(built, spec), 1);
  };
  const TestScene wide = BallUnderALamp(0.1f);
  const Estimate guided = mean(wide, true, 4096), chance = mean(wide, false, 8192);
  EXPECT_TRUE(Agree(guided, chance)) << guided.mean << " +- " << guided.standard_error << ", "
                                     << chance.mean << " +- " << chance.standard_error;
  EXPECT_FALSE(Agree({guided.mean * 1.1, guided.standard_error}, chance));
  // Of so small a lamp chance misses what the ball gathers; the guide finds as much of it.
  const TestScene small = BallUnderALamp(0.001f);
  EXPECT_TRUE(Agree(mean(small, true, 4096), guided));
  EXPECT_FALSE(Agree(mean(small, false, 4096), guided));
  EXPECT_GE(AgreeingShare(BuildScene(small), TestSpec(16, 64, 6), 1e-5), 0.999);
}

}  // namespace
}  // namespace strata
