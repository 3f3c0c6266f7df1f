#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/transport/cameras.h"
#include "tests/transport/kernels.h"
#include "tests/transport/test_scene.h"

// Cameras that are not perspective: what they see of simple scenes is known in closed form.

namespace strata {
namespace {

constexpr float kPiFloat = std::numbers::pi_v<float>;

TEST(OrthographicCamera, RaysAreParallelAndTheShorterEdgeSpansTwoUnits) {
  const CameraDescription description = CameraAt(CameraKind::kOrthographic, {1, 2, 3}, {1, 2, 9});
  const Camera camera = *Camera::Create(description, 200, 100);
  for (const Vec2f point : {Vec2f{0, 0}, Vec2f{100, 50}, Vec2f{200, 7}})
    ExpectNear(camera.GenerateRay(point, {}).direction, {0, 0, 1});
  ExpectNear(camera.GenerateRay({100, 50}, {}).origin, {1, 2, 3});
  ExpectNear(camera.GenerateRay({0, 0}, {}).origin, {-1, 3, 3});
  ExpectNear(camera.GenerateRay({200, 100}, {}).origin, {3, 1, 3});
  EXPECT_FLOAT_EQ(camera.Depth({7, 7, 8}), 5);
}

TEST(OrthographicCamera, TheWindowIsInUnitsOfItsSpace) {
  CameraDescription description = CameraAt(CameraKind::kOrthographic, {0, 0, 0}, {0, 0, 1});
  description.camera_to_world = description.camera_to_world * Transform::Scale(3, 3, 3);
  description.screen_window = {{-2, 4, -1, 1}};
  const Camera camera = *Camera::Create(description, 64, 64);
  ExpectNear(camera.GenerateRay({0, 0}, {}).origin, {-6, 3, 0});
  ExpectNear(camera.GenerateRay({64, 64}, {}).origin, {12, -3, 0});
  EXPECT_NEAR(Length(camera.GenerateRay({0, 0}, {}).direction), 1, 1e-6);
}

TEST(OrthographicCamera, LensBlursByItsCircleOfConfusion) {
  ExpectCirclesOfConfusion(CameraAt(CameraKind::kOrthographic, {0, 0, 0}, {0, 0, 1}));
}

TEST(SphericalCamera, EquirectangularColumnsAreLongitudesAndRowsColatitudes) {
  CameraDescription description = CameraAt(CameraKind::kSpherical, {0, 0, 0}, {0, 0, 1});
  description.spherical_mapping = EnvironmentMapping::kLatLong;
  const Camera camera = *Camera::Create(description, 400, 200);
  const auto toward = [&](float x, float y) { return camera.GenerateRay({x, y}, {}).direction; };
  ExpectNear(toward(0, 100), {1, 0, 0});
  ExpectNear(toward(100, 100), {0, 0, 1});  // Forward, as in pbrt, is a quarter from the left.
  ExpectNear(toward(200, 100), {-1, 0, 0});
  ExpectNear(toward(123, 0), {0, 1, 0});
  ExpectNear(toward(123, 200), {0, -1, 0});
  ExpectNear(toward(100, 50), Normalize(Vec3f{0, 1, 1}));
  EXPECT_FLOAT_EQ(camera.Depth({3, 0, -4}), 5);
}

TEST(SphericalCamera, TheEqualAreaSquareGoesOnOverItsEdges) {
  const Camera camera =
      *Camera::Create(CameraAt(CameraKind::kSpherical, {0, 0, 0}, {0, 0, 1}), 100, 100);
  const auto toward = [&](float x, float y) { return camera.GenerateRay({x, y}, {}).direction; };
  ExpectNear(toward(50, 50), {0, 1, 0});  // Up is in the middle, down at the corners.
  ExpectNear(toward(0, 0), {0, -1, 0});
  for (float s = 1; s < 100; s += 7) {
    for (const float e : {1e-3f, 0.5f}) {
      EXPECT_LT(Length(toward(-e, s) - toward(e, s)), 0.1f * e + 1e-5f) << s;
      EXPECT_LT(Length(toward(100 + e, s) - toward(100 - e, s)), 0.1f * e + 1e-5f) << s;
      EXPECT_LT(Length(toward(s, -e) - toward(s, e)), 0.1f * e + 1e-5f) << s;
      EXPECT_LT(Length(toward(s, 100 + e) - toward(s, 100 - e)), 0.1f * e + 1e-5f) << s;
    }
  }
}

TEST(SphericalCamera, EveryPixelOfAConstantEnvironmentIsItsRadiance) {
  for (const EnvironmentMapping mapping :
       {EnvironmentMapping::kEqualArea, EnvironmentMapping::kLatLong}) {
    TestScene scene;
    scene.Light(ConstantInfiniteLightDescription{{0.5f, 0.75f, 0.25f}});
    scene.description.camera = CameraAt(CameraKind::kSpherical, {0, 0, 0}, {1, 2, 3});
    scene.description.camera.spherical_mapping = mapping;
    JobSpec spec = TestSpec(16, 64, 2);
    spec.filter = DefaultFilter(FilterKind::kTriangle);
    const Partial partial = RenderFrame(BuildScene(scene), spec);
    for (int64_t pixel = 0; pixel < spec.crop.Pixels(); ++pixel)
      EXPECT_NEAR(PixelMean(partial, pixel, 1), 0.75, 1e-6);
  }
}

/// A lamp whose radiance is 1, so that a frame's mean is the part of it that shows the lamp.
TestScene Lamp(Vec3f center, float radius, CameraDescription camera) {
  TestScene scene;
  scene.Sphere(center, radius, scene.Diffuse(0.0f), Emits(1));
  scene.description.camera = camera;
  return scene;
}

TEST(OrthographicCamera, ASphereCoversItsCrossSection) {
  const TestScene scene =
      Lamp({0.1f, -0.2f, 5}, 0.7f, CameraAt(CameraKind::kOrthographic, {0, 0, 0}, {0, 0, 1}));
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(32, 512, 1)), kPiFloat * 0.49 / 4);
}

TEST(SphericalCamera, ASphereCoversItsSolidAngleOfTheEqualAreaSquare) {
  const TestScene scene =
      Lamp({1, -2, 2}, 1.5f, CameraAt(CameraKind::kSpherical, {0, 0, 0}, {0, 0, 1}));
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(32, 512, 1)), (1 - std::sqrt(1 - 0.25)) / 2);
}

TEST(SphericalCamera, ASphereAboveCoversItsAngleOfTheEquirectangularFrame) {
  TestScene scene = Lamp({0, 3, 0}, 1.5f, CameraAt(CameraKind::kSpherical, {0, 0, 0}, {0, 0, 1}));
  scene.description.camera.spherical_mapping = EnvironmentMapping::kLatLong;
  ExpectMean(RenderFrame(BuildScene(scene), TestSpec(32, 512, 1)), 1.0 / 6);
}

/// Something to see on all sides.
TestScene Surroundings() {
  TestScene scene;
  scene.Polygon({{-3, 0, -3}, {-3, 0, 3}, {3, 0, 3}, {3, 0, -3}},
                scene.Diffuse({0.8f, 0.5f, 0.2f}));
  scene.Sphere({0.5f, 0.6f, 1.2f}, 0.6f, scene.Material(DielectricMaterial{}));
  scene.Sphere({-1, 0.5f, -1}, 0.5f, scene.Diffuse(0.6f));
  scene.Sphere({1.5f, 2, -1}, 0.3f, scene.Diffuse(0.0f), Emits(10));
  scene.Light(ConstantInfiniteLightDescription{{0.1f, 0.2f, 0.3f}});
  return scene;
}

TEST(KernelsOfCameras, NearlyEverySampleIsTheSame) {
  TestScene scene = Surroundings();
  JobSpec spec = TestSpec(32, 64, 6);
  spec.filter = DefaultFilter(FilterKind::kGaussian);
  scene.description.camera = CameraAt(CameraKind::kOrthographic, {0, 2, -4}, {0, 0.5, 0});
  scene.description.camera.lens_radius = 0.1f;
  scene.description.camera.focal_distance = 4;
  EXPECT_GE(AgreeingShare(BuildScene(scene), spec, 1e-5), 0.999);
  for (const EnvironmentMapping mapping :
       {EnvironmentMapping::kEqualArea, EnvironmentMapping::kLatLong}) {
    scene.description.camera = CameraAt(CameraKind::kSpherical, {0, 1.2, 0}, {0, 1.2, 1});
    scene.description.camera.spherical_mapping = mapping;
    EXPECT_GE(AgreeingShare(BuildScene(scene), spec, 1e-5), 0.999);
  }
}

}  // namespace
}  // namespace strata
