#include <gtest/gtest.h>

#include "tests/transport/test_scene.h"

// Light sampling alone, BSDF sampling alone and both under MIS are three estimators of one number.
// Pairs are compared at p = 1e-5; the control is one of them with 3 % added.

namespace strata {
namespace {

/// A floor and a wall of the material, lit by a triangle, a sphere, a disk and the sky.
TestScene Studio(const MaterialDescription& description) {
  TestScene scene;
  const MaterialId material = scene.Material(description);
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
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(0.5f)});
  scene.Camera({0, 2, -4}, {0, 0.6f, 1}, 40);
  return scene;
}

void ExpectStrategiesAgree(const TestScene& scene) {
  const auto built = BuildScene(scene);
  JobSpec spec = TestSpec(24, 512, 4);
  const Estimate mis = FrameMean(RenderFrame(built, spec), 1);
  spec.seed = 8;
  const Estimate light = FrameMean(RenderFrame(built, spec, DirectStrategy::kLightOnly), 1);
  spec.seed = 9;
  const Estimate bsdf = FrameMean(RenderFrame(built, spec, DirectStrategy::kBsdfOnly), 1);
  EXPECT_TRUE(Agree(mis, light)) << mis.mean << " +- " << mis.standard_error << ", light only "
                                 << light.mean << " +- " << light.standard_error;
  EXPECT_TRUE(Agree(mis, bsdf)) << mis.mean << " +- " << mis.standard_error << ", BSDF only "
                                << bsdf.mean << " +- " << bsdf.standard_error;
  EXPECT_FALSE(Agree({mis.mean * 1.03, mis.standard_error}, light));
  EXPECT_FALSE(Agree({mis.mean * 1.03, mis.standard_error}, bsdf));
}

TEST(StrategyTest, AgreeOnDiffuseSurfaces) {
  TestScene scene;
  ExpectStrategiesAgree(Studio(DiffuseMaterial{}));
}

/// Texture ids below are of the textures that Studio's scene gets afterwards.
TestScene WithRoughness(MaterialDescription (*make)(Roughness), float roughness) {
  TestScene scene = Studio(DiffuseMaterial{0});
  const TextureId alpha = scene.Texture(Rgb::Gray(roughness));
  // The floor's material is the second, after pbrt's default.
  scene.description.materials[1] = make({.u = alpha, .v = alpha, .remap = false});
  return scene;
}

TEST(StrategyTest, AgreeOnRoughMetal) {
  TestScene scene = WithRoughness(
      [](Roughness r) {
        return MaterialDescription(ConductorMaterial{.reflectance = 0, .roughness = r});
      },
      0.2f);
  ExpectStrategiesAgree(scene);
}

TEST(StrategyTest, AgreeOnCoatedSurfaces) {
  TestScene scene = WithRoughness(
      [](Roughness r) {
        return MaterialDescription(CoatedDiffuseMaterial{.reflectance = 0, .roughness = r});
      },
      0.3f);
  scene.description.materials[1] = [&] {
    auto coated = std::get<CoatedDiffuseMaterial>(scene.description.materials[1]);
    coated.albedo = scene.Texture({});
    return coated;
  }();
  ExpectStrategiesAgree(scene);
}

TEST(StrategyTest, AgreeThroughRoughGlass) {
  TestScene scene = WithRoughness(
      [](Roughness r) {
        return MaterialDescription(DielectricMaterial{.eta = 1.5f, .roughness = r});
      },
      0.3f);
  ExpectStrategiesAgree(scene);
}

TEST(StrategyTest, AgreeInsideASphereLight) {
  TestScene scene;
  scene.Sphere({0.2f, 0.1f, 0}, 1, scene.Diffuse(0.4f), Emits(1, true), true);
  scene.Sphere({0, 0, 0.3f}, 0.2f, scene.Diffuse(0.7f));
  scene.Camera({0, 0, -0.6f}, {0, 0, 1}, 60);
  ExpectStrategiesAgree(scene);
}

}  // namespace
}  // namespace strata
