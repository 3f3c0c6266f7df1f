#include "worker/integrator/camera.h"

#include <array>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

/// x_min, x_max, y_min, y_max: the shorter side spans [-1, 1] unless the file says otherwise.
std::array<double, 4> ScreenWindow(const CameraDescription& camera, int width, int height) {
  if (camera.screen_window) {
    const std::array<float, 4>& w = *camera.screen_window;
    return {w[0], w[1], w[2], w[3]};
  }
  const double aspect = camera.frame_aspect ? *camera.frame_aspect : double(width) / height;
  if (aspect > 1) return {-aspect, aspect, -1, 1};
  return {-1, 1, -1 / aspect, 1 / aspect};
}

}  // namespace

absl::StatusOr<Camera> Camera::Create(const CameraDescription& description, int width, int height) {
  if (!(description.fov > 0 && description.fov < 180))
    return absl::InvalidArgumentError(absl::StrCat("camera: the field of view is ", description.fov,
                                                   " degrees; give one between 0 and 180"));
  const auto [x_min, x_max, y_min, y_max] = ScreenWindow(description, width, height);
  if (!(x_min < x_max && y_min < y_max))
    return absl::InvalidArgumentError(
        "camera: the screen window is empty; give x_min < x_max and y_min < y_max");
  if (description.lens_radius > 0 && !(description.focal_distance > 0))
    return absl::InvalidArgumentError(
        "camera: a lens needs a positive focal distance; set focaldistance or lensradius 0");

  const Transform& to_world = description.camera_to_world;
  Camera camera;
  camera.position_ = ToFloat(to_world.Point({0, 0, 0}));
  camera.right_ = ToFloat(to_world.Vector({1, 0, 0}));
  camera.up_ = ToFloat(to_world.Vector({0, 1, 0}));
  const Vec3f forward = ToFloat(to_world.Vector({0, 0, 1}));
  if (!IsFinite(camera.position_) || !(LengthSquared(forward) > 0))
    return absl::InvalidArgumentError("camera: its transform is degenerate; check LookAt");
  camera.forward_ = Normalize(forward);
  camera.lens_radius_ = description.lens_radius;
  camera.focal_distance_ = description.focal_distance;

  const double scale = Tan(Radians(description.fov) / 2);
  camera.corner_ = ToFloat(to_world.Vector({x_min * scale, y_max * scale, 1}));
  camera.per_x_ = ToFloat(to_world.Vector({(x_max - x_min) / width * scale, 0, 0}));
  camera.per_y_ = ToFloat(to_world.Vector({0, (y_min - y_max) / height * scale, 0}));
  return camera;
}

Ray Camera::GenerateRay(Vec2f point, Vec2f lens) const {
  const Vec3f direction = corner_ + per_x_ * point.x + per_y_ * point.y;
  if (lens_radius_ == 0) return {position_, Normalize(direction)};
  const Vec3f offset = (right_ * lens.x + up_ * lens.y) * lens_radius_;
  return {position_ + offset, Normalize(direction * focal_distance_ - offset)};
}

RayLanes Camera::GenerateRays(Vec2Lanes point, Vec2Lanes lens) const {
  const auto normalized = [](Vec3Lanes v) { return v * (1 / Sqrt(LengthSquared(v))); };
  const Vec3Lanes direction =
      SameVector(corner_) + SameVector(per_x_) * point.x + SameVector(per_y_) * point.y;
  RayLanes rays;
  rays.origin = SameVector(position_);
  rays.direction = normalized(direction);
  if (lens_radius_ == 0) return rays;
  const Vec3Lanes offset =
      (SameVector(right_) * lens.x + SameVector(up_) * lens.y) * SameFloat(lens_radius_);
  rays.origin = rays.origin + offset;
  rays.direction = normalized(direction * SameFloat(focal_distance_) - offset);
  return rays;
}

}  // namespace strata
