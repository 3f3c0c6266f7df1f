#pragma once

#include <optional>
#include <string>

#include "common/bundle.h"
#include "worker/math/box.h"
#include "worker/scene/scene_file.h"

// What a job may say of a scene beside its file: SceneOptions, and what stands in for a camera or a
// light that a file does not have.

namespace strata {

/// From where to where a camera looks; `fov` in degrees over the picture's shorter edge.
struct Viewpoint {
  Vec3d eye, look;
  float fov = 40;
};
/// "x,y,z,x,y,z" (eye, then a point in the middle of the picture) or the same with ",fov". None
/// when the text is not six or seven numbers; INVALID_ARGUMENT when they make no camera.
absl::StatusOr<std::optional<Viewpoint>> ParseViewpoint(const std::string& text);

/// A pinhole camera at the viewpoint, `up` upwards in the picture. In a right-handed world, as
/// glTF's, the picture's right is forward x up; in a left-handed one, as pbrt's, up x forward.
CameraDescription CameraAt(const Viewpoint& viewpoint, Vec3d up, bool right_handed);

/// A viewpoint before the box, a little from the left (of -x) and above (+y), from which all of it
/// is seen, whatever the picture's shape; glTF's things face +z.
Viewpoint FramingViewpoint(const Box& bounds);

/// Replaces the camera of a scene that has one. Its world is taken to be upright along the axis
/// nearest to the camera's own up. INVALID_ARGUMENT when `text` is no viewpoint.
absl::Status SetViewpoint(const std::string& text, SceneDescription* scene);

/// Replaces all infinite lights by the image `path` (a bundle path), which becomes one of the
/// files: square ones are pbrt-v4's equal-area layout, others latitude and longitude, whose middle
/// lies at -z in glTF's world. Up is the axis nearest to the camera's up.
absl::Status SetEnvironment(const FileSource& source, const std::string& path, SceneFile* file);

}  // namespace strata
