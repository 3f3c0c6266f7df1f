#include "worker/pbrt/scene_parser.h"

// The directives that change the current transform.

namespace strata {

absl::Status SceneParser::Concatenate(const Transform& transform) {
  state_.ctm = state_.ctm * transform;
  if (state_.ctm.IsFinite()) return absl::OkStatus();
  return ErrorAt(Here(), "the transform grows beyond all bounds");
}

absl::Status SceneParser::Identity() {
  state_.ctm = {};
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
  state_.ctm = Transform::FromColumns(columns);
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
  state_.ctm = it->second;
  return absl::OkStatus();
}

absl::Status SceneParser::TransformTimes() {
  double times[2];
  STRATA_RETURN_IF_ERROR(ReadNumbers(times, 2));
  context_.Warn(Here(), "TransformTimes is ignored; nothing moves");
  return absl::OkStatus();
}

absl::Status SceneParser::ActiveTransform() {
  STRATA_ASSIGN_OR_RETURN(const Token token, tokens().Next());
  if (token.kind != Token::Kind::kWord ||
      (token.text != "All" && token.text != "StartTime" && token.text != "EndTime")) {
    return ErrorAt(Here(), "ActiveTransform wants All, StartTime or EndTime");
  }
  if (token.text != "All") {
    context_.Warn(Here(),
                  "ActiveTransform is ignored; nothing moves, and the transforms of both "
                  "times are applied");
  }
  return absl::OkStatus();
}

}  // namespace strata
