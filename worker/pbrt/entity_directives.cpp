#include <algorithm>
#include <numbers>
#include <utility>

#include "worker/pbrt/mesh_files.h"
#include "worker/pbrt/scene_parser.h"
#include "worker/pbrt/version3.h"

// The directives that describe the frame and the things in the scene.

namespace strata {

// ---- before WorldBegin ----

absl::Status SceneParser::Camera() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type));
  STRATA_RETURN_IF_ERROR(ReadCamera(type, state_.ctm, parameters, context_));
  CameraDescription& camera = context_.scene.camera;
  camera.medium = state_.media.outside;
  coordinate_systems_["camera"] = {camera.camera_to_world,
                                   camera.camera_to_world_at_end.value_or(camera.camera_to_world)};
  return absl::OkStatus();
}

absl::Status SceneParser::Film() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type));
  return ReadFilm(type, parameters, context_);
}

absl::Status SceneParser::PixelFilter() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type));
  return ReadPixelFilter(type, parameters, context_);
}

absl::Status SceneParser::Sampler() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type));
  return ReadSampler(type, parameters, context_);
}

absl::Status SceneParser::Integrator() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type));
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
  STRATA_ASSIGN_OR_RETURN(std::string value_type, ReadString());
  STRATA_ASSIGN_OR_RETURN(std::string texture_class, ReadString());
  STRATA_ASSIGN_OR_RETURN(std::vector<Parameter> own, ParseParameters(tokens()));
  STRATA_RETURN_IF_ERROR(
      TranslateVersion3(directive_, Here(), &texture_class, &own, &context_.warnings));
  TranslateTextureType(Here(), &value_type, &context_.warnings);
  ParameterReader parameters = WithInherited(name, std::move(own), "texture");
  WarnOfMotion("a texture");
  return textures_.Define(name, value_type, texture_class, state_.ctm.start, state_.color_space,
                          parameters);
}

absl::Status SceneParser::Material() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type, "material"));
  STRATA_ASSIGN_OR_RETURN(state_.material, materials_.Add(type, state_.color_space, parameters));
  return absl::OkStatus();
}

absl::Status SceneParser::MakeNamedMaterial() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  STRATA_ASSIGN_OR_RETURN(std::vector<Parameter> own, ParseParameters(tokens()));
  const auto type = std::find_if(own.begin(), own.end(), [](const Parameter& parameter) {
    return parameter.name == "type" && parameter.strings.size() == 1;
  });
  if (type != own.end()) {
    Parameter word = std::move(*type);
    own.erase(type);
    STRATA_RETURN_IF_ERROR(
        TranslateVersion3("Material", Here(), &word.strings[0], &own, &context_.warnings));
    own.push_back(std::move(word));
  }
  ParameterReader parameters = WithInherited(name, std::move(own), "material");
  return materials_.Define(name, state_.color_space, parameters);
}

absl::Status SceneParser::NamedMaterial() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  state_.material = materials_.Use(name, Here());
  return absl::OkStatus();
}

absl::Status SceneParser::MakeNamedMedium() {
  STRATA_ASSIGN_OR_RETURN(const std::string name, ReadString());
  STRATA_ASSIGN_OR_RETURN(std::vector<Parameter> own, ParseParameters(tokens()));
  std::string type;  // Media have none that v3 words otherwise.
  STRATA_RETURN_IF_ERROR(TranslateVersion3(directive_, Here(), &type, &own, &context_.warnings));
  ParameterReader parameters = WithInherited(name, std::move(own), "medium");
  return media_.Define(name, state_.color_space, parameters);
}

absl::Status SceneParser::MediumInterface() {
  STRATA_ASSIGN_OR_RETURN(const std::string inside, ReadString());
  STRATA_ASSIGN_OR_RETURN(const Token token, tokens().Peek());
  std::string outside = inside;
  if (token.kind == Token::Kind::kString) {
    STRATA_ASSIGN_OR_RETURN(outside, ReadString());
  }
  state_.media = {media_.Use(inside, Here()), media_.Use(outside, Here())};
  return absl::OkStatus();
}

// ---- lights and shapes ----

absl::Status SceneParser::LightSource() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type, "light"));
  if (open_object_) return ErrorAt(Here(), "a LightSource cannot be part of an object");
  WarnOfMotion("a light");
  return ReadLight(type, state_.ctm.start, state_.color_space, parameters, context_);
}

absl::Status SceneParser::AreaLightSource() {
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type, "light"));
  STRATA_ASSIGN_OR_RETURN(state_.area_light,
                          ReadAreaLight(type, state_.color_space, parameters, textures_, context_));
  return absl::OkStatus();
}

absl::Status SceneParser::PlaceEmission(ShapeDescription& shape) {
  const AreaLight& light = *state_.area_light;
  if (std::holds_alternative<CurveShape>(shape.geometry)) {
    context_.Warn(Here(), "area lights that are curves are not supported; the shape does not emit");
    return absl::OkStatus();
  }
  if (open_object_) {
    context_.Warn(Here(), "area lights in objects are not supported; the shape does not emit");
    return absl::OkStatus();
  }
  if (state_.ctm.Moves()) {
    context_.Warn(Here(), "area lights that move are not supported; the shape does not emit");
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
  STRATA_ASSIGN_OR_RETURN(std::string type, ReadString());
  STRATA_ASSIGN_OR_RETURN(ParameterReader parameters, ReadTyped(&type, "shape"));
  const std::optional<AlphaMask> alpha =
      ReadAlpha(parameters, state_.area_light && !state_.ctm.Moves(), textures_, context_);
  STRATA_ASSIGN_OR_RETURN(std::optional<ShapeGeometry> geometry,
                          ReadShape(type, parameters, context_));
  if (!geometry || !alpha) return absl::OkStatus();
  const bool moves = state_.ctm.Moves() && !open_object_;
  if (open_object_) WarnOfMotion("a shape of an object");
  STRATA_RETURN_IF_ERROR(CheckPlacement(*geometry, state_.ctm.start, Here()));
  if (moves) STRATA_RETURN_IF_ERROR(CheckPlacement(*geometry, state_.ctm.end, Here()));
  ShapeDescription shape;
  shape.where = Here();
  shape.geometry = *std::move(geometry);
  if (!moves) shape.to_world = state_.ctm.start;  // Otherwise its instance is placed.
  shape.material = state_.material;
  shape.reverse_orientation = state_.reverse_orientation;
  shape.alpha = *alpha;
  if (state_.media.inside != state_.media.outside) shape.border = state_.media;
  if (state_.area_light) STRATA_RETURN_IF_ERROR(PlaceEmission(shape));
  auto& shapes = open_object_ ? context_.scene.objects[*open_object_].shapes
                 : moves      ? MovingShapes()
                              : context_.scene.shapes;
  if (std::holds_alternative<CurveShape>(shape.geometry)) {
    if (!IsSimilarity(state_.ctm.start)) {
      context_.Warn(Here(),
                    "a transform that stretches or shears leaves the cross-sections of curves "
                    "round; their width scales by its mean factor");
    }
    if (!shapes.empty() && JoinCurves(shapes.back(), shape)) return absl::OkStatus();
  }
  shapes.push_back(std::move(shape));
  return absl::OkStatus();
}

// ---- objects ----

std::vector<ShapeDescription>& SceneParser::MovingShapes() {
  auto& objects = context_.scene.objects;
  auto& instances = context_.scene.instances;
  const auto is_placed_alike = [&](const InstanceDescription& instance) {
    return instance.to_world == state_.ctm.start && instance.to_world_at_end == state_.ctm.end;
  };
  if (!moving_instance_ || !is_placed_alike(instances[*moving_instance_])) {
    moving_instance_ = instances.size();
    const int32_t object = static_cast<int32_t>(objects.size());
    objects.push_back({"shapes that move", {}});
    object_states_.push_back({true, Here()});
    instances.push_back({Here(), object, state_.ctm.start, state_.ctm.end});
  }
  return objects[instances[*moving_instance_].object].shapes;
}

int32_t SceneParser::ObjectNamed(const std::string& name) {
  const auto [it, is_new] =
      objects_.try_emplace(name, static_cast<int32_t>(context_.scene.objects.size()));
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
  context_.scene.instances.push_back(
      {Here(), ObjectNamed(name), state_.ctm.start, state_.ctm.MovedEnd()});
  return absl::OkStatus();
}

}  // namespace strata
