#include "worker/integrator/camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/transport/cameras.h"

namespace strata {
namespace {

CameraDescription At(Vec3d eye, Vec3d look) {
  CameraDescription camera = CameraAt(CameraKind::kPerspective, eye, look);
  camera.fov = 60;
  return camera;
}

TEST(CameraTest, CenterLooksForwardAndTheShorterEdgeSpansTheFieldOfView) {
  // Looking along +x with y up: pbrt's camera space is left-handed, so the picture's right is -z.
  const Camera camera = *Camera::Create(At({1, 2, 3}, {5, 2, 3}), 200, 100);
  ExpectNear(camera.GenerateRay({100, 50}, {}).direction, {1, 0, 0});
  ExpectNear(camera.GenerateRay({100, 50}, {}).origin, {1, 2, 3});
  const float half = std::tan(std::numbers::pi_v<float> / 6);
  ExpectNear(camera.GenerateRay({100, 0}, {}).direction, Normalize(Vec3f{1, half, 0}));
  ExpectNear(camera.GenerateRay({100, 100}, {}).direction, Normalize(Vec3f{1, -half, 0}));
  ExpectNear(camera.GenerateRay({200, 50}, {}).direction, Normalize(Vec3f{1, 0, -2 * half}));
  ExpectNear(camera.forward(), {1, 0, 0});
}

TEST(CameraTest, TallFramesSpanTheFieldOfViewAcross) {
  const Camera camera = *Camera::Create(At({0, 0, 0}, {0, 0, 1}), 100, 200);
  const float half = std::tan(std::numbers::pi_v<float> / 6);
  ExpectNear(camera.GenerateRay({100, 100}, {}).direction, Normalize(Vec3f{half, 0, 1}));
  ExpectNear(camera.GenerateRay({50, 0}, {}).direction, Normalize(Vec3f{0, 2 * half, 1}));
}

TEST(CameraTest, ScreenWindowAndAspectCanBeGiven) {
  CameraDescription description = At({0, 0, 0}, {0, 0, 1});
  description.fov = 90;
  description.screen_window = {{-0.5f, 1, -0.25f, 0.75f}};
  const Camera window = *Camera::Create(description, 64, 64);
  ExpectNear(window.GenerateRay({0, 0}, {}).direction, Normalize(Vec3f{-0.5f, 0.75f, 1}));
  ExpectNear(window.GenerateRay({64, 64}, {}).direction, Normalize(Vec3f{1, -0.25f, 1}));
  description.screen_window.reset();
  description.frame_aspect = 2;
  const Camera aspect = *Camera::Create(description, 64, 64);
  ExpectNear(aspect.GenerateRay({64, 32}, {}).direction, Normalize(Vec3f{2, 0, 1}));
}

TEST(CameraTest, LensBlursByItsCircleOfConfusion) {
  ExpectCirclesOfConfusion(At({0, 0, 0}, {0, 0, 1}));
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
