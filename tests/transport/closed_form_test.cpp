#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tests/transport/test_scene.h"

// Scenes whose radiance is known in closed form. Each check is a test of the mean at p = 1e-5; each
// has a control that shows that an error of 1 % (or as stated) would be found.

namespace strata {
namespace {

constexpr double kPiDouble = std::numbers::pi;

/// A diffuse floor in y = 0, seen at the origin alone, which the camera does not shade.
TestScene Receiver(float reflectance, Vec3f eye = {1, 1, 3}) {
  TestScene scene;
  scene.Polygon({{-50, 0, -50}, {-50, 0, 50}, {50, 0, 50}, {50, 0, -50}},
                scene.Diffuse(reflectance));
  scene.Camera(eye, {0, 0, 0}, 0.01f);
  return scene;
}

/// Radiance of a diffuse surface of reflectance 0.6 under the irradiance.
constexpr float kReflectance = 0.6f;
double Reflected(double irradiance) { return kReflectance / kPiDouble * irradiance; }

Partial RenderReceiver(const TestScene& scene, uint32_t spp = 64) {
  return RenderFrame(BuildScene(scene), TestSpec(16, spp, 1));
}

// ---- the closed furnace: inside a body that emits Le everywhere, radiance is Le / (1 - rho) ----
//
// That holds of walls whose albedo is the same from all directions: diffuse ones, those that let
// through diffusely, and mixes of them. What absorbs nothing (a clear dielectric, a smooth coat
// over white) is tested as a body within a furnace, where it cannot be seen, and as the walls of
// one that a lamp lights. The albedo of metals, of coats over what absorbs and of rough borders
// changes with the direction, so that radiance in a closed body of them has no closed form; they
// are compared with quadrature under an open sky (albedo_test.cpp). A mirror's is known along its
// normal.

class Furnace : public testing::TestWithParam<float> {};

TEST_P(Furnace, DiffuseSphereHoldsEmissionOverOneMinusReflectance) {
  const float rho = GetParam();
  TestScene scene;
  scene.Sphere({0, 0, 0}, 1, scene.Diffuse(rho), Emits(0.5f), true);
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  // The more light there is from many bounces, the more roulette makes it vary.
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 128, 1000)), 0.5 / (1 - rho),
             rho > 0.7f ? 0.05 : 0.01);
}

TEST_P(Furnace, DiffuseBoxHoldsEmissionOverOneMinusReflectance) {
  const float rho = GetParam();
  TestScene scene;
  const MaterialId material = scene.Diffuse(rho);
  const AreaEmission emission = Emits(0.5f);
  const Vec3f c[8] = {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1},
                      {-1, -1, 1},  {1, -1, 1},  {1, 1, 1},  {-1, 1, 1}};
  for (const auto& [i, j, k, l] :
       {std::array{0, 1, 2, 3}, std::array{5, 4, 7, 6}, std::array{4, 0, 3, 7},
        std::array{1, 5, 6, 2}, std::array{4, 5, 1, 0}, std::array{3, 2, 6, 7}})
    scene.Polygon({c[i], c[j], c[k], c[l]}, material, emission);
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 128, 1000)), 0.5 / (1 - rho),
             rho > 0.7f ? 0.05 : 0.02);
}

INSTANTIATE_TEST_SUITE_P(Reflectances, Furnace, testing::Values(0.0f, 0.2f, 0.5f, 0.8f, 0.95f));

TEST(FurnaceTest, BouncesAreCountedAsPbrtCountsMaxdepth) {
  TestScene scene;
  scene.Sphere({0, 0, 0}, 1, scene.Diffuse(0.5f), Emits(1), true);
  scene.Camera({0, 0, 0}, {0, 0, 1}, 70);
  const auto built = BuildScene(scene);
  // Emission, and one more power of the reflectance for each bounce.
  for (int depth = 0; depth <= 4; ++depth)
    ExpectMean(RenderFrame(built, TestSpec(16, 64, depth)), 2 - std::pow(0.5, depth));
}

TEST(FurnaceTest, MirrorSphereSeenFromItsCenter) {
  // Paths through the center meet the mirror at normal incidence for ever.
  TestScene scene;
  const TextureId reflectance = scene.Texture(Rgb::Gray(0.75f));
  scene.Sphere({0, 0, 0}, 1, scene.Material(ConductorMaterial{.reflectance = reflectance}),
               Emits(1), true);
  scene.Camera({0, 0, 0}, {0, 0, 1}, 70);
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 256, 1000)), 4, 0.03);
}

TEST(FurnaceTest, TranslucentSphereTakesInTheSky) {
  // Lit from outside by the sky alone, since it is convex: L = (Le + tau sky) / (1 - rho).
  TestScene scene;
  const TextureId rho = scene.Texture(Rgb::Gray(0.5f)), tau = scene.Texture(Rgb::Gray(0.3f));
  scene.Sphere(
      {0, 0, 0}, 1,
      scene.Material(DiffuseTransmissionMaterial{.reflectance = rho, .transmittance = tau}),
      Emits(0.25f), true);
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(2)});
  scene.Camera({0.3f, 0, 0}, {0, 0, 1}, 70);
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 128, 1000)), (0.25 + 0.3 * 2) / 0.5, 0.02);
}

TEST(FurnaceTest, MixedWallsReflectTheirMean) {
  TestScene scene;
  const MaterialId half = scene.Diffuse(0.5f), dark = scene.Diffuse(0.1f);
  const MaterialId mixed = scene.Material(MixMaterial{half, dark, scene.Texture(Rgb::Gray(0.25f))});
  scene.Sphere({0, 0, 0}, 1, mixed, Emits(0.3f), true);
  scene.Camera({0.3f, 0.2f, -0.1f}, {0, 0, 1}, 70);
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 128, 1000)), 0.3 / 0.6);
}

/// Materials that absorb nothing from any direction.
std::vector<MaterialId> LosslessMaterials(TestScene& scene) {
  const MaterialId glass = scene.Material(DielectricMaterial{.eta = 1.5f});
  const MaterialId pane = scene.Material(ThinDielectricMaterial{.eta = 1.5f});
  const MaterialId plastic = scene.Material(CoatedDiffuseMaterial{
      .reflectance = scene.Texture(Rgb::Gray(1)), .eta = 1.5f, .thickness = 0});
  const TextureId half = scene.Texture(Rgb::Gray(0.5f));
  const MaterialId paper =
      scene.Material(DiffuseTransmissionMaterial{.reflectance = half, .transmittance = half});
  const MaterialId mixed = scene.Material(MixMaterial{plastic, pane, half});
  return {glass, pane, plastic, paper, mixed};
}

TEST(FurnaceTest, BodiesThatAbsorbNothingVanishInAUniformSky) {
  TestScene base;
  base.Light(ConstantInfiniteLightDescription{Rgb::Gray(1.5f)});
  base.Camera({0, 0, -3}, {0, 0, 0}, 30);
  for (const MaterialId material : LosslessMaterials(base)) {
    TestScene scene = base;
    scene.Sphere({0, 0, 0}, 1, material);
    ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 256, 1000)), 1.5);
  }
}

TEST(FurnaceTest, BodiesThatAbsorbNothingVanishInAClosedFurnace) {
  TestScene base;
  base.Sphere({0, 0, 0}, 1, base.Diffuse(0.5f), Emits(0.4f), true);
  base.Camera({0, 0, -0.8f}, {0, 0, 0}, 50);
  for (const MaterialId material : LosslessMaterials(base)) {
    TestScene scene = base;
    scene.Sphere({0.1f, 0, 0}, 0.4f, material);
    ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 256, 1000)), 0.8, 0.02);
  }
}

TEST(FurnaceTest, WhiteWallsHoldTheRadianceOfALampOverOneMinusItsReflectance) {
  TestScene base;
  const MaterialId plastic = base.Material(CoatedDiffuseMaterial{
      .reflectance = base.Texture(Rgb::Gray(1)), .eta = 1.5f, .thickness = 0});
  const MaterialId white = base.Diffuse(1.0f);
  const MaterialId mixed =
      base.Material(MixMaterial{plastic, white, base.Texture(Rgb::Gray(0.5f))});
  base.Sphere({0.1f, 0, 0}, 0.5f, base.Diffuse(0.4f), Emits(0.3f));
  base.Camera({0, 0, -0.8f}, {0, 0.3f, 0}, 70);
  for (const MaterialId walls : {plastic, white, mixed}) {
    TestScene scene = base;
    scene.Sphere({0, 0, 0}, 1, walls);
    ExpectMean(RenderFrame(BuildScene(scene), TestSpec(16, 256, 1000)), 0.3 / 0.6, 0.02);
  }
}

// ---- irradiance ----

/// Lambert's formula: a polygon of radiance 1 seen from the origin of a floor with normal y.
double PolygonIrradiance(const std::vector<Vec3f>& corners) {
  double sum = 0;
  for (size_t i = 0; i < corners.size(); ++i) {
    const Vec3f a = corners[i], b = corners[(i + 1) % corners.size()];
    const double angle = std::acos(double(Dot(a, b)) / (double(Length(a)) * double(Length(b))));
    sum += angle * Normalize(Cross(b, a)).y;
  }
  return std::abs(sum) / 2;
}

TEST(IrradianceTest, PolygonsFollowLambertsFormula) {
  const std::vector<std::vector<Vec3f>> polygons = {
      {{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}},
      {{2, 0.5f, -1}, {2, 3, 0}, {2, 0.5f, 1}},
      {{-0.1f, 0.3f, -0.1f}, {0.1f, 0.3f, -0.1f}, {0.1f, 0.4f, 0.1f}, {-0.1f, 0.4f, 0.1f}},
      {{-9, 1, -9}, {9, 1, -9}, {9, 1, 9}, {-9, 1, 9}},
  };
  for (const std::vector<Vec3f>& polygon : polygons) {
    TestScene scene = Receiver(kReflectance, {-3, 0.9f, 0});
    scene.Polygon(polygon, scene.Diffuse(0.0f), Emits(3, true));
    ExpectMean(RenderReceiver(scene, 256), Reflected(3 * PolygonIrradiance(polygon)));
  }
}

TEST(IrradianceTest, SpheresOfEverySizeFollowTheirClosedForm) {
  // pi L (R/d)^2 cos, as long as the sphere is above the horizon.
  for (const auto& [radius, distance] :
       {std::pair{1.0f, 2.0f}, {0.5f, 0.5001f / 0.6f}, {1e-3f, 4.0f}, {1e-2f, 100.0f}}) {
    const Vec3f direction = Normalize(Vec3f{0.8f, 0.6f, 0});
    TestScene scene = Receiver(kReflectance, {-3, 1, 1});
    scene.Sphere(direction * distance, radius, scene.Diffuse(0.0f), Emits(5));
    const double ratio = double(radius) / distance;
    ExpectMean(RenderReceiver(scene, 256), Reflected(kPiDouble * 5 * ratio * ratio * direction.y));
  }
}

TEST(IrradianceTest, DiskOnItsAxis) {
  TestScene scene = Receiver(kReflectance, {3, 1, 1});
  ShapeDescription disk;
  disk.geometry = DiskShape{.radius = 0.7f};
  disk.to_world = Transform::Translate(0, 2, 0) * Transform::Rotate(90, 1, 0, 0);
  disk.material = scene.Diffuse(0.0f);
  disk.emission = Emits(3, true);
  scene.description.shapes.push_back(disk);
  const double sin2 = 0.49 / (0.49 + 4);
  ExpectMean(RenderReceiver(scene, 256), Reflected(kPiDouble * 3 * sin2));
}

TEST(IrradianceTest, InsideOfALampIsUniform) {
  // A small floor within an emissive sphere sees nothing but the lamp.
  TestScene scene;
  scene.Polygon({{-0.1f, 0, -0.1f}, {-0.1f, 0, 0.1f}, {0.1f, 0, 0.1f}, {0.1f, 0, -0.1f}},
                scene.Diffuse(kReflectance));
  scene.Sphere({0.1f, 0.2f, 0}, 1, scene.Diffuse(0.0f), Emits(3), true);
  scene.Camera({0.2f, 0.4f, 0}, {0, 0, 0}, 0.01f);
  ExpectMean(RenderReceiver(scene, 256), Reflected(kPiDouble * 3));
}

TEST(IrradianceTest, PointLight) {
  TestScene scene = Receiver(kReflectance);
  scene.Light(PointLightDescription{{0, 3, 4}, Rgb::Gray(10)});
  ExpectMean(RenderReceiver(scene), Reflected(10.0 * 3 / 125), 1e-3);
}

TEST(IrradianceTest, DistantLight) {
  TestScene scene = Receiver(kReflectance);
  scene.Light(DistantLightDescription{{0, 0.6f, 0.8f}, Rgb::Gray(10)});
  ExpectMean(RenderReceiver(scene), Reflected(10.0 * 0.6), 1e-3);
}

TEST(IrradianceTest, ConstantSky) {
  TestScene scene = Receiver(kReflectance);
  scene.Light(ConstantInfiniteLightDescription{Rgb::Gray(2)});
  ExpectMean(RenderReceiver(scene), Reflected(kPiDouble * 2));
}

TEST(IrradianceTest, LightsOfAllKindsAddUp) {
  TestScene scene;
  scene.Polygon({{-2, 0, -2}, {-2, 0, 2}, {2, 0, 2}, {2, 0, -2}}, scene.Diffuse(kReflectance));
  const std::vector<Vec3f> lamp = {{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}};
  scene.Polygon(lamp, scene.Diffuse(0.0f), Emits(1, true));
  scene.Light(DistantLightDescription{{0, 0.6f, 0.8f}, Rgb::Gray(1)});
  // Faint, but near: chosen seldom, and worth much when it is.
  scene.Light(PointLightDescription{{0, 0.5f, 0}, Rgb::Gray(0.5f)});
  scene.Light(DistantLightDescription{{0, 0.8f, -0.6f}, Rgb::Gray(2)});
  scene.Camera({-3, 0.9f, 0}, {0, 0, 0}, 0.01f);
  ExpectMean(RenderReceiver(scene, 1024),
             Reflected(PolygonIrradiance(lamp) + 0.6 + 0.5 / 0.25 + 2 * 0.8), 0.03);
}

TEST(IrradianceTest, TwoSidedEmissionIsSeenFromBothSides) {
  const std::vector<Vec3f> lamp = {{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}, {-1, 2, 1}};
  // The normal of this order of corners points up, away from the floor.
  for (const bool two_sided : {false, true}) {
    std::vector<Vec3f> corners = lamp;
    if (Cross(lamp[1] - lamp[0], lamp[2] - lamp[0]).y < 0)
      std::reverse(corners.begin(), corners.end());
    TestScene scene = Receiver(kReflectance, {-3, 0.9f, 0});
    scene.Polygon(corners, scene.Diffuse(0.0f), Emits(3, two_sided));
    const Estimate estimate = FrameMean(RenderReceiver(scene, 64), 1);
    if (two_sided)
      EXPECT_TRUE(Agrees(estimate, Reflected(3 * PolygonIrradiance(lamp))));
    else
      EXPECT_EQ(estimate.mean, 0);
  }
}

}  // namespace
}  // namespace strata
