#include "worker/integrator/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "worker/light/environment_map.h"
#include "worker/math/cpu_clones.h"
#include "worker/math/elementary.h"
#include "worker/math/motion.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

struct ScreenRect {
  double x_min, x_max, y_min, y_max;
};

/// The shorter side, or the height, spans [-1, 1] unless the file says otherwise.
ScreenRect ScreenWindow(const CameraDescription& camera, int width, int height) {
  if (camera.screen_window) {
    const std::array<float, 4>& w = *camera.screen_window;
    return {w[0], w[1], w[2], w[3]};
  }
  const double aspect = camera.frame_aspect ? *camera.frame_aspect : double(width) / height;
  if (aspect > 1 || camera.fov_is_vertical) return {-aspect, aspect, -1, 1};
  return {-1, 1, -1 / aspect, 1 / aspect};
}

absl::Status CheckDescription(const CameraDescription& description) {
  if (description.kind == CameraKind::kPerspective &&
      !(description.fov > 0 && description.fov < 180))
    return absl::InvalidArgumentError(absl::StrCat("camera: the field of view is ", description.fov,
                                                   " degrees; give one between 0 and 180"));
  if (description.lens_radius > 0 && !(description.focal_distance > 0))
    return absl::InvalidArgumentError(
        "camera: a lens needs a positive focal distance; set focaldistance or lensradius 0");
  return absl::OkStatus();
}

/// The point of the equal-area square that continues it at (x, y), a little outside: its edges are
/// folded in their middles. (Filters reach over the frame's edge.)
Vec2f WrapEqualAreaSquare(Vec2f st) {
  if (st.x < 0 || st.x > 1) st = {st.x < 0 ? -st.x : 2 - st.x, 1 - st.y};
  if (st.y < 0 || st.y > 1) st = {1 - st.x, st.y < 0 ? -st.y : 2 - st.y};
  return st;
}

}  // namespace

absl::StatusOr<Camera> Camera::Create(const CameraDescription& description, int width, int height) {
  STRATA_RETURN_IF_ERROR(CheckDescription(description));
  const ScreenRect window = ScreenWindow(description, width, height);
  if (!(window.x_min < window.x_max && window.y_min < window.y_max))
    return absl::InvalidArgumentError(
        "camera: the screen window is empty; give x_min < x_max and y_min < y_max");

  const bool orthographic = description.kind == CameraKind::kOrthographic;
  const double scale = orthographic ? 1 : Tan(Radians(description.fov) / 2);
  const auto pose_of = [&](const Transform& to_world) {
    Pose pose;
    pose.position = ToFloat(to_world.Point({0, 0, 0}));
    pose.right = ToFloat(to_world.Vector({1, 0, 0}));
    pose.up = ToFloat(to_world.Vector({0, 1, 0}));
    pose.view = ToFloat(to_world.Vector({0, 0, 1}));
    const double left = window.x_min * scale, top = window.y_max * scale;
    pose.corner =
        ToFloat(orthographic ? to_world.Point({left, top, 0}) : to_world.Vector({left, top, 1}));
    pose.per_x = ToFloat(to_world.Vector({(window.x_max - window.x_min) / width * scale, 0, 0}));
    pose.per_y = ToFloat(to_world.Vector({0, (window.y_min - window.y_max) / height * scale, 0}));
    return pose;
  };
  Camera camera;
  camera.kind_ = description.kind;
  camera.pose_ = pose_of(description.camera_to_world);
  if (!IsFinite(camera.pose_.position) || !(LengthSquared(camera.pose_.view) > 0))
    return absl::InvalidArgumentError("camera: its transform is degenerate; check LookAt");
  camera.forward_ = Normalize(camera.pose_.view);
  if (description.camera_to_world_at_end) {
    const auto steps =
        MotionSteps(description.camera_to_world, *description.camera_to_world_at_end);
    if (!steps)
      return absl::InvalidArgumentError(
          "camera: it cannot move as its transforms at start and end say; check that both are "
          "invertible and that not just one of them mirrors");
    for (const Transform& step : *steps) camera.motion_.push_back(pose_of(step));
  }
  camera.shutter_open_ = description.shutter_open;
  camera.shutter_close_ = description.shutter_close;
  camera.lens_radius_ = description.kind == CameraKind::kSpherical ? 0 : description.lens_radius;
  camera.focal_distance_ = description.focal_distance;
  camera.mapping_ = description.spherical_mapping;
  camera.per_pixel_ = {1 / static_cast<float>(width), 1 / static_cast<float>(height)};
  return camera;
}

float Camera::TimeAt(float u) const {
  return std::clamp(shutter_open_ + u * (shutter_close_ - shutter_open_), 0.0f, 1.0f);
}

Camera::Pose Camera::PoseAt(float time) const {
  const MotionTime at(time, static_cast<int>(motion_.size()) - 1);
  const Pose &a = motion_[at.step], &b = motion_[at.step + 1];
  const auto between = [&](Vec3f from, Vec3f to) {
    return from * (1 - at.fraction) + to * at.fraction;
  };
  return {between(a.position, b.position), between(a.right, b.right),   between(a.up, b.up),
          between(a.view, b.view),         between(a.corner, b.corner), between(a.per_x, b.per_x),
          between(a.per_y, b.per_y)};
}

Ray Camera::GenerateRay(Vec2f point, Vec2f lens, float time) const {
  return moves() ? RayFrom(PoseAt(time), point, lens) : RayFrom(pose_, point, lens);
}

Ray Camera::RayFrom(const Pose& pose, Vec2f point, Vec2f lens) const {
  if (kind_ == CameraKind::kSpherical) return SphericalRay(pose, point);
  const Vec3f on_frame = pose.corner + pose.per_x * point.x + pose.per_y * point.y;
  const Vec3f offset = (pose.right * lens.x + pose.up * lens.y) * lens_radius_;
  if (kind_ == CameraKind::kOrthographic) {
    // Each point of the frame has a lens of its own before it, whose axis is along the view.
    return {on_frame + offset, Normalize(pose.view * focal_distance_ - offset)};
  }
  if (lens_radius_ == 0) return {pose.position, Normalize(on_frame)};
  return {pose.position + offset, Normalize(on_frame * focal_distance_ - offset)};
}

Ray Camera::SphericalRay(const Pose& pose, Vec2f point) const {
  Vec2f st = {point.x * per_pixel_.x, point.y * per_pixel_.y};
  if (mapping_ == EnvironmentMapping::kEqualArea) st = WrapEqualAreaSquare(st);
  // The mapping's pole is up, and its first meridian to the right.
  const Vec3f d = SquareToSphere(mapping_, st);
  return {pose.position, Normalize(pose.right * d.x + pose.up * d.z + pose.view * d.y)};
}

std::optional<Camera::FrameRect> Camera::RectOf(const Geometry::Bounds& box) const {
  if (moves() || kind_ == CameraKind::kSpherical) return std::nullopt;
  const bool perspective = kind_ == CameraKind::kPerspective;
  const Vec3d per_x = ToDouble(pose_.per_x), per_y = ToDouble(pose_.per_y);
  const Vec3d corner = ToDouble(pose_.corner), view = ToDouble(pose_.view);
  // A point is origin + depth * axis + x * scale * per_x + y * scale * per_y, where the scale is
  // the depth for perspective cameras and 1 for others.
  const Vec3d origin = perspective ? ToDouble(pose_.position) : corner;
  const Vec3d axis = perspective ? corner : view;
  const Vec3d across = Cross(per_x, per_y);
  const double volume = Dot(axis, across);
  const double lens_x = lens_radius_ * Length(ToDouble(pose_.right)) / Length(per_x);
  const double lens_y = lens_radius_ * Length(ToDouble(pose_.up)) / Length(per_y);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  FrameRect rect = {kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (int i = 0; i < 8; ++i) {
    const Vec3d p = {i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y,
                     i & 4 ? box.max.z : box.min.z};
    const Vec3d offset = p - origin;
    const double depth = Dot(offset, across) / volume;
    if (perspective && !(depth > 1e-6 * Length(offset) / Length(axis))) return std::nullopt;
    const double scale = perspective ? depth : 1;
    const double x = Dot(offset, Cross(per_y, axis)) / (volume * scale);
    const double y = Dot(offset, Cross(axis, per_x)) / (volume * scale);
    // Seen from the edge of the lens, what is out of focus moves.
    const double blur = lens_radius_ > 0 ? std::abs(1 - depth / focal_distance_) / scale : 0;
    rect.x0 = std::min(rect.x0, x - blur * lens_x);
    rect.x1 = std::max(rect.x1, x + blur * lens_x);
    rect.y0 = std::min(rect.y0, y - blur * lens_y);
    rect.y1 = std::max(rect.y1, y + blur * lens_y);
  }
  if (!(std::isfinite(rect.x0 + rect.y0) && std::isfinite(rect.x1 + rect.y1))) return std::nullopt;
  return rect;
}

float Camera::Depth(Vec3f p, float time) const {
  return moves() ? DepthFrom(PoseAt(time), p) : DepthFrom(pose_, p);
}

float Camera::DepthFrom(const Pose& pose, Vec3f p) const {
  const Vec3f offset = p - pose.position;
  return kind_ == CameraKind::kSpherical ? Length(offset) : Dot(offset, Normalize(pose.view));
}

STRATA_CPU_CLONES RayLanes Camera::GenerateRays(Vec2Lanes point, Vec2Lanes lens, FloatLanes time,
                                                MaskLanes mask) const {
  RayLanes rays;
  if (kind_ != CameraKind::kPerspective || moves()) {
    ForEachLane(mask, [&](int lane) {
      const Ray ray =
          GenerateRay({point.x[lane], point.y[lane]}, {lens.x[lane], lens.y[lane]}, time[lane]);
      rays.origin.Set(lane, ray.origin);
      rays.direction.Set(lane, ray.direction);
    });
    return rays;
  }
  const auto normalized = [](Vec3Lanes v) { return v * (1 / Sqrt(LengthSquared(v))); };
  const Vec3Lanes direction = SameVector(pose_.corner) + SameVector(pose_.per_x) * point.x +
                              SameVector(pose_.per_y) * point.y;
  rays.origin = SameVector(pose_.position);
  rays.direction = normalized(direction);
  if (lens_radius_ == 0) return rays;
  const Vec3Lanes offset =
      (SameVector(pose_.right) * lens.x + SameVector(pose_.up) * lens.y) * SameFloat(lens_radius_);
  rays.origin = rays.origin + offset;
  rays.direction = normalized(direction * SameFloat(focal_distance_) - offset);
  return rays;
}

}  // namespace strata
