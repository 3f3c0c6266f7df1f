#include <numbers>
#include <utility>

#include "worker/pbrt/mesh_files.h"
#include "worker/pbrt/scene_parser.h"

// The directives that describe the frame and the things in the scene.

namespace strata {

// ---- before WorldBegin ----

absl::Status SceneParser::Camera() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type));
  STRATA_RETURN_IF_ERROR(ReadCamera(type, state_.ctm, parameters, context_));
  coordinate_systems_["camera"] = context_.scene.camera.camera_to_world;
  return absl::OkStatus();
}

absl::Status SceneParser::Film() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type));
  return ReadFilm(type, parameters, context_);
}

absl::Status SceneParser::PixelFilter() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type));
  return ReadPixelFilter(type, parameters, context_);
}

absl::Status SceneParser::Sampler() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type));
  return ReadSampler(type, parameters, context_);
}

absl::Status SceneParser::Integrator() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type));
  return ReadIntegrator(type, parameters, context_);
}

absl::Status SceneParser::Accelerator() {
  // How rays are traced changes nothing in the picture.
  STRATA_RETURN_IF_ERROR(ReadString().status());
  return ParseParameters(tokens()).status();
}

// ---- textures, materials, media ----

absl::Status SceneParser::Texture() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  STRATA_ASSIGN_OR_RETURN(const std::string value_type, ReadString());
  STRATA_ASSIGN_OR_RETURN(const std::string texture_class, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(name, "texture"));
  return textures_.Define(name, value_type, texture_class, state_.ctm, state_.color_space,
                          parameters);
}

absl::Status SceneParser::Material() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type, "material"));
  STRATA_ASSIGN_OR_RETURN(state_.material, materials_.Add(type, state_.color_space, parameters));
  return absl::OkStatus();
}

absl::Status SceneParser::MakeNamedMaterial() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(name, "material"));
  return materials_.Define(name, state_.color_space, parameters);
}

absl::Status SceneParser::NamedMaterial() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  state_.material = materials_.Use(name, Here());
  return absl::OkStatus();
}

absl::Status SceneParser::MakeNamedMedium() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  STRATA_RETURN_IF_ERROR(ParseParameters(tokens()).status());
  context_.Warn(Here(), StrCat("participating media are not supported; \"", name,
                               "\" is left out, as if it were clear"));
  return absl::OkStatus();
}

absl::Status SceneParser::MediumInterface() {
  STRATA_RETURN_IF_ERROR(ReadString().status());
  STRATA_ASSIGN_OR_RETURN(const Token token, tokens().Peek());
  if (token.kind == Token::Kind::kString) STRATA_RETURN_IF_ERROR(ReadString().status());
  context_.Warn(Here(), "MediumInterface is ignored; participating media are not supported");
  return absl::OkStatus();
}

// ---- lights and shapes ----

absl::Status SceneParser::LightSource() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type, "light"));
  if (open_object_) return ErrorAt(Here(), "a LightSource cannot be part of an object");
  return ReadLight(type, state_.ctm, state_.color_space, parameters, context_);
}

absl::Status SceneParser::AreaLightSource() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type, "light"));
  STRATA_ASSIGN_OR_RETURN(state_.area_light,
                          ReadAreaLight(type, state_.color_space, parameters, textures_, context_));
  return absl::OkStatus();
}

absl::Status SceneParser::PlaceEmission(ShapeDescription& shape) {
  const AreaLight& light = *state_.area_light;
  if (open_object_) {
    context_.Warn(Here(), "area lights in objects are not supported; the shape does not emit");
    return absl::OkStatus();
  }
  Rgb radiance = light.radiance;
  if (light.power) {
    STRATA_RETURN_IF_ERROR(ReadMeshFile(&shape, context_));
    STRATA_ASSIGN_OR_RETURN(const double area, WorldArea(shape.geometry, shape.to_world, Here()));
    const double sides = light.two_sided ? 2 : 1;
    if (!(area > 0)) return ErrorAt(Here(), "the area light's power has no area to leave by");
    radiance = radiance * static_cast<float>(*light.power / (sides * area * std::numbers::pi));
  }
  if (IsBlack(radiance)) return absl::OkStatus();
  if (!IsFinite(radiance)) return ErrorAt(light.where, "the area light is too bright");
  shape.emission = AreaEmission{radiance, light.two_sided, light.image};
  return absl::OkStatus();
}

absl::Status SceneParser::Shape() {
  STRATA_ASSIGN_OR_RETURN(const std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadParameters(type, "shape"));
  const std::optional<AlphaMask> alpha =
      ReadAlpha(parameters, state_.area_light.has_value(), textures_, context_);
  STRATA_ASSIGN_OR_RETURN(std::optional<ShapeGeometry> geometry,
                          ReadShape(type, parameters, context_));
  if (!geometry || !alpha) return absl::OkStatus();
  STRATA_RETURN_IF_ERROR(CheckPlacement(*geometry, state_.ctm, Here()));
  ShapeDescription shape;
  shape.where = Here();
  shape.geometry = *std::move(geometry);
  shape.to_world = state_.ctm;
  shape.material = state_.material;
  shape.reverse_orientation = state_.reverse_orientation;
  shape.alpha = *alpha;
  if (state_.area_light) STRATA_RETURN_IF_ERROR(PlaceEmission(shape));
  auto& shapes =
      open_object_ ? context_.scene.objects[*open_object_].shapes : context_.scene.shapes;
  shapes.push_back(std::move(shape));
  return absl::OkStatus();
}

// ---- objects ----

int32_t SceneParser::ObjectNamed(const std::string& name) {
  const auto [it, is_new] = objects_.try_emplace(name, static_cast<int32_t>(objects_.size()));
  if (is_new) {
    context_.scene.objects.push_back({name, {}});
    object_states_.push_back({false, Here()});
  }
  return it->second;
}

absl::Status SceneParser::ObjectBegin() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  if (open_object_) return ErrorAt(Here(), "ObjectBegin inside another object");
  const int32_t object = ObjectNamed(name);
  if (object_states_[object].defined) {
    return ErrorAt(Here(), StrCat("object \"", name, "\" is defined twice"));
  }
  STRATA_RETURN_IF_ERROR(OpenScope(ScopeKind::kObject));
  object_states_[object].defined = true;
  open_object_ = object;
  return absl::OkStatus();
}

absl::Status SceneParser::ObjectEnd() {
  STRATA_RETURN_IF_ERROR(CloseScope(ScopeKind::kObject, "ObjectBegin"));
  open_object_.reset();
  return absl::OkStatus();
}

absl::Status SceneParser::ObjectInstance() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  if (open_object_) return ErrorAt(Here(), "ObjectInstance inside an object");
  if (!state_.ctm.Inverse()) {
    return ErrorAt(Here(), "the instance's transform cannot be inverted; check its scale");
  }
  context_.scene.instances.push_back({Here(), ObjectNamed(name), state_.ctm});
  return absl::OkStatus();
}

}  // namespace strata
