#include <algorithm>
#include <array>

#include "worker/pbrt/entities.h"

namespace strata {
namespace {

void ReadLens(ParameterReader& parameters, CameraDescription& camera) {
  camera.lens_radius = static_cast<float>(parameters.Float("lensradius", 0));
  camera.focal_distance = static_cast<float>(parameters.Float("focaldistance", 1e6));
  if (camera.lens_radius < 0) {
    parameters.Fail(parameters.where(), "\"float lensradius\" must not be negative");
  }
  if (!(camera.focal_distance > 0)) {
    parameters.Fail(parameters.where(), "\"float focaldistance\" must be more than 0");
  }
}

void ReadWindow(ParameterReader& parameters, CameraDescription& camera) {
  const SourceLocation& where = parameters.where();
  if (parameters.Has("frameaspectratio")) {
    camera.frame_aspect = static_cast<float>(parameters.Float("frameaspectratio", 1));
    if (!(*camera.frame_aspect > 0)) {
      parameters.Fail(where, "\"float frameaspectratio\" must be more than 0");
    }
  }
  if (!parameters.Has("screenwindow")) return;
  const std::vector<double> window = parameters.Floats("screenwindow");
  if (window.size() != 4 || !(window[0] < window[1]) || !(window[2] < window[3])) {
    parameters.Fail(where, "\"float screenwindow\" wants x0 < x1 and y0 < y1");
    return;
  }
  camera.screen_window = std::array<float, 4>{};
  std::transform(window.begin(), window.end(), camera.screen_window->begin(),
                 [](double value) { return static_cast<float>(value); });
}

void ReadFieldOfView(ParameterReader& parameters, CameraDescription& camera) {
  camera.fov = static_cast<float>(parameters.Float("fov", 90));
  if (!(camera.fov > 0 && camera.fov < 180)) {
    parameters.Fail(parameters.where(),
                    "\"float fov\" must be more than 0 and less than 180 degrees");
  }
}

void ReadMapping(ParameterReader& parameters, CameraDescription& camera) {
  const std::string mapping = parameters.String("mapping", "equalarea");
  if (mapping == "equirectangular") {
    camera.spherical_mapping = EnvironmentMapping::kLatLong;
  } else if (mapping != "equalarea") {
    parameters.Fail(parameters.where(), StrCat("unknown mapping \"", mapping,
                                               "\" of a spherical camera; use equalarea or "
                                               "equirectangular"));
  }
  // What every pbrt camera takes, and this one has no use for.
  for (const std::string_view name :
       {"lensradius", "focaldistance", "frameaspectratio", "screenwindow"}) {
    parameters.Ignore(name);
  }
}

void ReadShutter(ParameterReader& parameters, CameraDescription& camera) {
  camera.shutter_open = static_cast<float>(parameters.Float("shutteropen", 0));
  camera.shutter_close = static_cast<float>(parameters.Float("shutterclose", 1));
  if (camera.shutter_close < camera.shutter_open) {
    parameters.Fail(parameters.where(), "\"shutterclose\" must not be before \"shutteropen\"");
  }
}

}  // namespace

absl::Status ReadCamera(const std::string& type, const AnimatedTransform& camera_from_world,
                        ParameterReader& parameters, ReadContext& context) {
  const SourceLocation& where = parameters.where();
  CameraDescription camera;
  const std::optional<AnimatedTransform> inverse = camera_from_world.Inverse();
  if (!inverse) return ErrorAt(where, "the camera's transform cannot be inverted");
  camera.camera_to_world = inverse->start;
  camera.camera_to_world_at_end = inverse->MovedEnd();
  if (type == "perspective" || type == "orthographic") {
    camera.kind = type == "perspective" ? CameraKind::kPerspective : CameraKind::kOrthographic;
    ReadLens(parameters, camera);
    ReadWindow(parameters, camera);
    if (camera.kind == CameraKind::kPerspective) ReadFieldOfView(parameters, camera);
  } else if (type == "spherical") {
    camera.kind = CameraKind::kSpherical;
    ReadMapping(parameters, camera);
  } else if (type == "realistic") {
    return ErrorAt(where,
                   "Camera \"realistic\", a system of lenses, is not supported; use perspective "
                   "with \"fov\", \"lensradius\" and \"focaldistance\"");
  } else {
    return ErrorAt(
        where, StrCat("unknown Camera \"", type, "\"; use perspective, orthographic or spherical"));
  }
  ReadShutter(parameters, camera);
  context.scene.camera = camera;
  return parameters.Finish(context.warnings);
}

}  // namespace strata
