#pragma once

#include "common/status.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/scene/description.h"

namespace strata {

/// A perspective camera with a thin lens, ready for one frame size (PBRT 5.2). Camera space: x
/// right, y up, z forward.
class Camera {
 public:
  /// INVALID_ARGUMENT when the field of view, screen window or transform make no picture.
  static absl::StatusOr<Camera> Create(const CameraDescription& description, int width, int height);

  /// The ray through the point (x, y) of the frame, in pixels from its upper left corner.
  /// `lens` is a point of the unit disk.
  Ray GenerateRay(Vec2f point, Vec2f lens) const;
  /// Eight of them.
  RayLanes GenerateRays(Vec2Lanes point, Vec2Lanes lens) const;

  bool has_lens() const { return lens_radius_ > 0; }
  Vec3f position() const { return position_; }
  Vec3f forward() const { return forward_; }  ///< Unit.

 private:
  Vec3f position_, right_, up_, forward_;  ///< The lens and camera space's axes, in world space.
  /// Direction (world) through the frame's upper left corner, and its change per pixel.
  Vec3f corner_, per_x_, per_y_;
  float lens_radius_ = 0;
  float focal_distance_ = 0;
};

}  // namespace strata
