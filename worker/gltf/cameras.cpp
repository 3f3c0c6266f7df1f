#include "worker/gltf/cameras.h"

#include <algorithm>
#include <cmath>

#include "common/text.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

constexpr double kPi64 = 3.14159265358979323846;

/// The place and the axes, without the scale that nodes above may bring.
absl::StatusOr<Transform> Rigid(const GltfDocument& document, const Transform& to_world,
                                const std::string& element) {
  const Vec3d right = Normalize(to_world.Vector({1, 0, 0}));
  const Vec3d up = Normalize(to_world.Vector({0, 1, 0}));
  const Vec3d forward = Normalize(to_world.Vector({0, 0, -1}));
  const Vec3d eye = to_world.Point({0, 0, 0});
  Transform rigid;
  rigid.m = {{{right.x, up.x, forward.x, eye.x},
              {right.y, up.y, forward.y, eye.y},
              {right.z, up.z, forward.z, eye.z},
              {0, 0, 0, 1}}};
  if (!rigid.IsFinite()) return document.Error(element, "its camera's transform is singular");
  return rigid;
}

}  // namespace

absl::Status SetCamera(GltfDocument& document, int index, const Transform& to_world,
                       const std::string& element) {
  STRATA_ASSIGN_OR_RETURN(
      const tinygltf::Camera* camera,
      document.Find(document.model().cameras, index, "camera", element + ".camera"));
  const std::string name = ElementName("cameras", index);
  CameraDescription description;
  STRATA_ASSIGN_OR_RETURN(description.camera_to_world, Rigid(document, to_world, element));
  FrameDefaults& frame = document.scene.defaults;
  double aspect = static_cast<double>(frame.width) / frame.height;
  if (camera->type == "perspective") {
    if (camera->perspective.aspectRatio > 0) aspect = camera->perspective.aspectRatio;
    const double fov = camera->perspective.yfov;
    if (!(fov > 0 && fov < kPi64))
      return document.Error(name + ".perspective.yfov", "it must lie between 0 and pi");
    description.fov = static_cast<float>(180 / kPi64 * fov);
    description.fov_is_vertical = true;
  } else if (camera->type == "orthographic") {
    const tinygltf::OrthographicCamera& ortho = camera->orthographic;
    if (!(ortho.xmag > 0 && ortho.ymag > 0))
      return document.Error(name + ".orthographic", "xmag and ymag must be above 0");
    aspect = ortho.xmag / ortho.ymag;
    description.kind = CameraKind::kOrthographic;
    // The shorter edge spans two units of camera space, whatever the picture's shape.
    const double half_edge = std::min(ortho.xmag, ortho.ymag);
    description.camera_to_world =
        description.camera_to_world * Transform::Scale(half_edge, half_edge, 1);
  } else {
    return document.Error(name + ".type",
                          StrCat("\"", camera->type, "\" is neither perspective nor orthographic"));
  }
  constexpr double kLargestAspect = 20;
  if (!(aspect >= 1 / kLargestAspect && aspect <= kLargestAspect))
    return document.Error(name, "its aspect ratio is not within 1/20 and 20");
  frame.width = static_cast<int>(std::lround(frame.height * aspect));
  document.scene.camera = description;
  return absl::OkStatus();
}

bool IsCameraCalled(const GltfDocument& document, const tinygltf::Node& node,
                    const std::string& wanted) {
  if (node.camera < 0) return false;
  if (wanted == node.name || wanted == std::to_string(node.camera)) return true;
  const auto& cameras = document.model().cameras;
  return static_cast<size_t>(node.camera) < cameras.size() && wanted == cameras[node.camera].name;
}

}  // namespace strata
