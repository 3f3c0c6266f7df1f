#include "worker/scene/scene_options.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

Vec3d Axis(int index, double sign) {
  return {index == 0 ? sign : 0, index == 1 ? sign : 0, index == 2 ? sign : 0};
}

/// The axis, with its sign, nearest to `v`; +y for no direction.
Vec3d NearestAxis(Vec3d v) {
  const std::array<double, 3> parts = {v.x, v.y, v.z};
  int most = 1;
  for (int i = 0; i < 3; ++i) {
    if (std::abs(parts[i]) > std::abs(parts[most])) most = i;
  }
  return Axis(most, parts[most] < 0 ? -1 : 1);
}

Vec3d UpOf(const CameraDescription& camera) {
  return NearestAxis(camera.camera_to_world.Vector({0, 1, 0}));
}

/// A camera has x right, y up, z forward, which is left-handed.
bool IsRightHanded(const CameraDescription& camera) {
  return camera.camera_to_world.SwapsHandedness();
}

/// The right of one who looks along `forward`.
Vec3d RightOf(Vec3d forward, Vec3d up, bool right_handed) {
  return right_handed ? Cross(forward, up) : Cross(up, forward);
}

Transform FromAxes(Vec3d x, Vec3d y, Vec3d z, Vec3d origin) {
  Transform t;
  t.m = {{{x.x, y.x, z.x, origin.x},
          {x.y, y.y, z.y, origin.y},
          {x.z, y.z, z.z, origin.z},
          {0, 0, 0, 1}}};
  return t;
}

/// The image's middle lies ahead of one who looks along z, or -z in a right-handed world (x where z
/// is up); it is seen from within, not mirrored.
Transform EnvironmentToWorld(Vec3d up, bool right_handed) {
  const Vec3d ahead = up.z != 0 ? Vec3d{1, 0, 0} : Vec3d{0, 0, right_handed ? -1.0 : 1.0};
  return FromAxes(-ahead, -RightOf(ahead, up, right_handed), up, {});
}

}  // namespace

absl::StatusOr<std::optional<Viewpoint>> ParseViewpoint(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ',');
  std::array<double, 7> numbers = {0, 0, 0, 0, 0, 0, Viewpoint{}.fov};
  if (parts.size() != 6 && parts.size() != 7) return std::nullopt;
  for (size_t i = 0; i < parts.size(); ++i) {
    if (!absl::SimpleAtod(parts[i], &numbers[i])) return std::nullopt;
    if (!std::isfinite(numbers[i]))
      return absl::InvalidArgumentError(
          absl::StrCat("camera \"", text, "\": ", parts[i], " is no finite number"));
  }
  const auto [x, y, z, to_x, to_y, to_z, fov] = numbers;
  const Viewpoint viewpoint = {{x, y, z}, {to_x, to_y, to_z}, static_cast<float>(fov)};
  if (!(Length(viewpoint.look - viewpoint.eye) > 0))
    return absl::InvalidArgumentError(
        absl::StrCat("camera \"", text, "\": it looks at the point where it stands"));
  if (!(viewpoint.fov > 0 && viewpoint.fov < 180))
    return absl::InvalidArgumentError(absl::StrCat("camera \"", text, "\": the field of view is ",
                                                   fov, " degrees; give one between 0 and 180"));
  return viewpoint;
}

CameraDescription CameraAt(const Viewpoint& viewpoint, Vec3d up, bool right_handed) {
  const Vec3d forward = Normalize(viewpoint.look - viewpoint.eye);
  Vec3d right = RightOf(forward, up, right_handed);
  // Straight up or down: any direction is as good.
  if (!(Length(right) > 1e-6)) {
    right = RightOf(forward, up.z != 0 ? Vec3d{0, 1, 0} : Vec3d{0, 0, 1}, right_handed);
  }
  right = Normalize(right);
  const Vec3d upward = right_handed ? Cross(right, forward) : Cross(forward, right);
  CameraDescription camera;
  camera.camera_to_world = FromAxes(right, upward, forward, viewpoint.eye);
  camera.fov = viewpoint.fov;
  return camera;
}

Viewpoint FramingViewpoint(const Box& bounds) {
  Viewpoint viewpoint;
  viewpoint.look = bounds.Empty() ? Vec3d{} : Lerp(0.5, bounds.min, bounds.max);
  const double radius = bounds.Empty() ? 1 : 0.5 * Length(bounds.max - bounds.min);
  const Vec3d towards_eye = Normalize(Vec3d{0.5, 0.35, 1});
  const double distance =
      std::max(radius, 1e-6) / Sin(std::numbers::pi / 360 * static_cast<double>(viewpoint.fov));
  viewpoint.eye = viewpoint.look + towards_eye * distance;
  return viewpoint;
}

absl::Status SetViewpoint(const std::string& text, SceneDescription* scene) {
  STRATA_ASSIGN_OR_RETURN(const std::optional<Viewpoint> viewpoint, ParseViewpoint(text));
  if (!viewpoint)
    return absl::InvalidArgumentError(absl::StrCat(
        "camera \"", text,
        "\" is not understood; give x,y,z,x,y,z (eye, point looked at) or the same with ,FOV"));
  const CameraDescription& before = scene->camera;
  scene->camera = CameraAt(*viewpoint, UpOf(before), IsRightHanded(before));
  return absl::OkStatus();
}

absl::Status SetEnvironment(const FileSource& source, const std::string& path, SceneFile* file) {
  STRATA_RETURN_IF_ERROR(Annotate(source.Locate(path).status(), "environment"));
  std::erase_if(file->scene.lights, [](const LightDescription& light) {
    return std::holds_alternative<ConstantInfiniteLightDescription>(light.light) ||
           std::holds_alternative<ImageInfiniteLightDescription>(light.light);
  });
  ImageInfiniteLightDescription image;
  image.path = path;
  image.to_world = EnvironmentToWorld(UpOf(file->scene.camera), IsRightHanded(file->scene.camera));
  image.mapping = EnvironmentMapping::kByShape;
  file->scene.lights.push_back({{path, 1}, image});
  const auto at = std::lower_bound(file->files.begin(), file->files.end(), path);
  if (at == file->files.end() || *at != path) file->files.insert(at, path);
  return absl::OkStatus();
}

}  // namespace strata
