#pragma once

#include <gtest/gtest.h>

#include <cmath>

#include "worker/integrator/camera.h"

namespace strata {

/// A camera at `eye` that looks at `look`, with y up.
inline CameraDescription CameraAt(CameraKind kind, Vec3d eye, Vec3d look) {
  CameraDescription camera;
  camera.kind = kind;
  camera.camera_to_world = *Transform::LookAt(eye, look, {0, 1, 0})->Inverse();
  return camera;
}

inline void ExpectNear(Vec3f a, Vec3f b) {
  EXPECT_NEAR(a.x, b.x, 1e-5);
  EXPECT_NEAR(a.y, b.y, 1e-5);
  EXPECT_NEAR(a.z, b.z, 1e-5);
}

/// The rays of a pixel meet in the plane of focus, at depth f; at depth z they fill a circle of the
/// lens radius times |z - f| / f. `description` looks along +z from the origin.
inline void ExpectCirclesOfConfusion(CameraDescription description) {
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
      for (const float z : {1.0f, 3.0f, 8.0f})
        EXPECT_NEAR(Length(at_depth(lens, z) - at_depth({}, z)), 0.2f * std::abs(z - 4) / 4, 1e-5);
    }
  }
}

}  // namespace strata
