#include "worker/integrator/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace strata {
namespace {

CameraDescription At(Vec3d eye, Vec3d look) {
  CameraDescription camera;
  camera.camera_to_world = *Transform::LookAt(eye, look, {0, 1, 0})->Inverse();
  camera.fov = 60;
  return camera;
}

void ExpectNear(Vec3f a, Vec3f b) {
  EXPECT_NEAR(a.x, b.x, 1e-5);
  EXPECT_NEAR(a.y, b.y, 1e-5);
  EXPECT_NEAR(a.z, b.z, 1e-5);
}

TEST(CameraTest, CenterLooksForwardAndTheShorterEdgeSpansTheFieldOfView) {
  // Looking along +x with y up: pbrt's camera space is left-handed, so the picture's right is -z.
  const Camera camera = *Camera::Create(At({1, 2, 3}, {5, 2, 3}), 200, 100);
  ExpectNear(camera.GenerateRay({100, 50}, {}).direction, {1, 0, 0});
  ExpectNear(camera.GenerateRay({100, 50}, {}).origin, {1, 2, 3});
  const float half = std::tan(std::numbers::pi_v<float> / 6);
  ExpectNear(camera.GenerateRay({100, 0}, {}).direction, Normalize({1, half, 0}));
  ExpectNear(camera.GenerateRay({100, 100}, {}).direction, Normalize({1, -half, 0}));
  ExpectNear(camera.GenerateRay({200, 50}, {}).direction, Normalize({1, 0, -2 * half}));
  ExpectNear(camera.forward(), {1, 0, 0});
}

TEST(CameraTest, TallFramesSpanTheFieldOfViewAcross) {
  const Camera camera = *Camera::Create(At({0, 0, 0}, {0, 0, 1}), 100, 200);
  const float half = std::tan(std::numbers::pi_v<float> / 6);
  ExpectNear(camera.GenerateRay({100, 100}, {}).direction, Normalize({half, 0, 1}));
  ExpectNear(camera.GenerateRay({50, 0}, {}).direction, Normalize({0, 2 * half, 1}));
}

TEST(CameraTest, ScreenWindowAndAspectCanBeGiven) {
  CameraDescription description = At({0, 0, 0}, {0, 0, 1});
  description.fov = 90;
  description.screen_window = {{-0.5f, 1, -0.25f, 0.75f}};
  const Camera window = *Camera::Create(description, 64, 64);
  ExpectNear(window.GenerateRay({0, 0}, {}).direction, Normalize({-0.5f, 0.75f, 1}));
  ExpectNear(window.GenerateRay({64, 64}, {}).direction, Normalize({1, -0.25f, 1}));
  description.screen_window.reset();
  description.frame_aspect = 2;
  const Camera aspect = *Camera::Create(description, 64, 64);
  ExpectNear(aspect.GenerateRay({64, 32}, {}).direction, Normalize({2, 0, 1}));
}

TEST(CameraTest, LensBlursByItsCircleOfConfusion) {
  CameraDescription description = At({0, 0, 0}, {0, 0, 1});
  description.lens_radius = 0.2f;
  description.focal_distance = 4;
  const Camera camera = *Camera::Create(description, 64, 64);
  for (const Vec2f pixel : {Vec2f{32, 32}, Vec2f{7, 50}}) {
    const auto at_depth = [&](Vec2f lens, float z) {
      const Ray ray = camera.GenerateRay(pixel, lens);
      return ray.origin + ray.direction * ((z - ray.origin.z) / ray.direction.z);
    };
    for (const Vec2f lens : {Vec2f{1, 0}, Vec2f{0, -1}, Vec2f{0.6f, 0.8f}}) {
      ExpectNear(at_depth(lens, 4), at_depth({}, 4));
      // Radius of the circle at depth z: lens radius times |z - f| / f.
      for (const float z : {1.0f, 3.0f, 8.0f})
        EXPECT_NEAR(Length(at_depth(lens, z) - at_depth({}, z)), 0.2f * std::abs(z - 4) / 4, 1e-5);
    }
  }
}

TEST(CameraTest, RefusesWhatMakesNoPicture) {
  CameraDescription description = At({0, 0, 0}, {0, 0, 1});
  description.fov = 180;
  EXPECT_EQ(Camera::Create(description, 8, 8).status().code(), absl::StatusCode::kInvalidArgument);
  description.fov = 40;
  description.screen_window = {{1, 1, -1, 1}};
  EXPECT_EQ(Camera::Create(description, 8, 8).status().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace strata
