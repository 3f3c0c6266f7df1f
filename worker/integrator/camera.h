#pragma once

#include <optional>
#include <vector>

#include "common/status.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/scene/description.h"

namespace strata {

/// A camera ready for one frame size: perspective or orthographic with a thin lens (PBRT 5.2), or
/// spherical (PBRT 5.3). Camera space: x right, y up, z forward.
class Camera {
 public:
  /// INVALID_ARGUMENT when the field of view, screen window or transform make no picture.
  static absl::StatusOr<Camera> Create(const CameraDescription& description, int width, int height);

  /// The ray through the point (x, y) of the frame, in pixels from its upper left corner.
  /// `lens` is a point of the unit disk, `time` of motion.
  Ray GenerateRay(Vec2f point, Vec2f lens, float time = 0) const;
  /// Of the lanes in `mask`.
  RayLanes GenerateRays(Vec2Lanes point, Vec2Lanes lens, FloatLanes time, MaskLanes mask) const;

  /// A rectangle of the frame, in pixels from its upper left corner.
  struct FrameRect {
    double x0, y0, x1, y1;
  };
  /// Holds all points of the frame at which something in `box` can be seen, through any point of
  /// the lens. None where no such bound is known: the camera moves or is spherical, or part of the
  /// box is not before it.
  std::optional<FrameRect> RectOf(const Geometry::Bounds& box) const;

  bool has_lens() const { return lens_radius_ > 0; }
  bool moves() const { return !motion_.empty(); }
  /// The time of motion, in [0, 1], when the part u of the shutter's time has passed.
  float TimeAt(float u) const;

  // Where it does not move, or at its start:
  Vec3f position() const { return pose_.position; }
  Vec3f forward() const { return forward_; }  ///< Unit.

  /// The depth of a point at a time: along the view, but the distance for spherical cameras.
  float Depth(Vec3f p, float time = 0) const;

 private:
  /// Where the camera is. All change linearly with the elements of its transform.
  struct Pose {
    Vec3f position, right, up, view;  ///< The lens' centre, camera space's axes, in world space.
    /// Perspective: direction (world) through the frame's upper left corner, and its change per
    /// pixel. Orthographic: that corner, and its change.
    Vec3f corner, per_x, per_y;
  };

  Ray RayFrom(const Pose& pose, Vec2f point, Vec2f lens) const;
  Ray SphericalRay(const Pose& pose, Vec2f point) const;
  Pose PoseAt(float time) const;
  float DepthFrom(const Pose& pose, Vec3f p) const;

  CameraKind kind_ = CameraKind::kPerspective;
  Pose pose_;
  std::vector<Pose> motion_;  ///< At equal steps of time, straight between them; none: it rests.
  Vec3f forward_;
  float shutter_open_ = 0, shutter_close_ = 1;
  float lens_radius_ = 0;
  float focal_distance_ = 0;
  EnvironmentMapping mapping_ = EnvironmentMapping::kEqualArea;
  Vec2f per_pixel_;  ///< Spherical: of the unit square that the frame is.
};

}  // namespace strata
