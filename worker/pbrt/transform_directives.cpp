#include <cmath>

#include "worker/pbrt/scene_parser.h"

// The directives that change the current transform.

namespace strata {

absl::Status SceneParser::Concatenate(const Transform& transform) {
  Replace({state_.ctm.start * transform, state_.ctm.end * transform});
  if (state_.ctm.start.IsFinite() && state_.ctm.end.IsFinite()) return absl::OkStatus();
  return ErrorAt(Here(), "the transform grows beyond all bounds");
}

void SceneParser::Replace(const AnimatedTransform& transform) {
  if (state_.at_start) state_.ctm.start = transform.start;
  if (state_.at_end) state_.ctm.end = transform.end;
}

void SceneParser::WarnOfMotion(std::string_view what) {
  if (!state_.ctm.Moves()) return;
  context_.Warn(Here(), StrCat(what, " cannot move; it stays where it is at the start"));
}

absl::Status SceneParser::Identity() {
  Replace({});
  return absl::OkStatus();
}

absl::Status SceneParser::Translate() {
  double v[3];
  STRATA_RETURN_IF_ERROR(ReadNumbers(v, 3));
  return Concatenate(Transform::Translate(v[0], v[1], v[2]));
}

absl::Status SceneParser::Scale() {
  double v[3];
  STRATA_RETURN_IF_ERROR(ReadNumbers(v, 3));
  if (v[0] == 0 || v[1] == 0 || v[2] == 0) {
    return ErrorAt(Here(), "Scale by 0 cannot be inverted");
  }
  return Concatenate(Transform::Scale(v[0], v[1], v[2]));
}

absl::Status SceneParser::Rotate() {
  double v[4];
  STRATA_RETURN_IF_ERROR(ReadNumbers(v, 4));
  if (v[1] == 0 && v[2] == 0 && v[3] == 0) {
    return ErrorAt(Here(), "Rotate wants an axis that is not 0 0 0");
  }
  return Concatenate(Transform::Rotate(v[0], v[1], v[2], v[3]));
}

absl::Status SceneParser::LookAt() {
  double v[9];
  STRATA_RETURN_IF_ERROR(ReadNumbers(v, 9));
  const std::optional<Transform> look =
      Transform::LookAt({v[0], v[1], v[2]}, {v[3], v[4], v[5]}, {v[6], v[7], v[8]});
  if (!look) {
    return ErrorAt(Here(),
                   "LookAt wants an eye and a target apart, and an up vector that is not "
                   "along the view");
  }
  return Concatenate(*look);
}

absl::Status SceneParser::SetTransform() {
  std::array<double, 16> columns;
  STRATA_RETURN_IF_ERROR(ReadNumbers(columns.data(), 16));
  const Transform transform = Transform::FromColumns(columns);
  Replace({transform, transform});
  return absl::OkStatus();
}

absl::Status SceneParser::ConcatTransform() {
  std::array<double, 16> columns;
  STRATA_RETURN_IF_ERROR(ReadNumbers(columns.data(), 16));
  return Concatenate(Transform::FromColumns(columns));
}

absl::Status SceneParser::CoordinateSystem() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  coordinate_systems_[name] = state_.ctm;
  return absl::OkStatus();
}

absl::Status SceneParser::CoordSysTransform() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  const auto it = coordinate_systems_.find(name);
  if (it == coordinate_systems_.end()) {
    return ErrorAt(Here(), StrCat("there is no coordinate system \"", name,
                                  "\"; define it with CoordinateSystem"));
  }
  Replace(it->second);
  return absl::OkStatus();
}

absl::Status SceneParser::TransformTimes() {
  double times[2];
  STRATA_RETURN_IF_ERROR(ReadNumbers(times, 2));
  if (!(times[0] < times[1])) {
    return ErrorAt(Here(), "TransformTimes wants a start before the end");
  }
  motion_start_ = times[0];
  motion_end_ = times[1];
  return absl::OkStatus();
}

absl::Status SceneParser::ActiveTransform() {
  STRATA_ASSIGN_OR_RETURN(const Token token, tokens().Next());
  if (token.kind != Token::Kind::kWord ||
      (token.text != "All" && token.text != "StartTime" && token.text != "EndTime")) {
    return ErrorAt(Here(), "ActiveTransform wants All, StartTime or EndTime");
  }
  state_.at_start = token.text != "EndTime";
  state_.at_end = token.text != "StartTime";
  return absl::OkStatus();
}

/// From seconds to the times of motion.
absl::Status SceneParser::PlaceShutter() {
  CameraDescription& camera = context_.scene.camera;
  const auto of_motion = [&](float seconds) {
    return static_cast<float>((seconds - motion_start_) / (motion_end_ - motion_start_));
  };
  camera.shutter_open = of_motion(camera.shutter_open);
  camera.shutter_close = of_motion(camera.shutter_close);
  if (std::isfinite(camera.shutter_open) && std::isfinite(camera.shutter_close))
    return absl::OkStatus();
  return ErrorAt(Here(), "the shutter is too far from the TransformTimes to be computed with");
}

}  // namespace strata
