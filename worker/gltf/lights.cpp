#include "worker/gltf/lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/text.h"
#include "worker/gltf/extension.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

/// Colour times intensity.
absl::StatusOr<Rgb> StrengthOf(const GltfDocument& document, const tinygltf::Light& light,
                               const std::string& element) {
  Rgb color = {1, 1, 1};
  if (!light.color.empty()) {
    if (light.color.size() != 3)
      return document.Error(element + ".color", "it must be an array of 3 numbers");
    color = {static_cast<float>(light.color[0]), static_cast<float>(light.color[1]),
             static_cast<float>(light.color[2])};
  }
  const Rgb strength = color * static_cast<float>(light.intensity);
  if (!IsFinite(strength) || std::min({strength.r, strength.g, strength.b}) < 0)
    return document.Error(element, "colour and intensity must be finite and not negative");
  return strength;
}

}  // namespace

absl::Status AddLight(GltfDocument& document, const tinygltf::Node& node, const Transform& to_world,
                      const std::string& element) {
  const GltfExtension extension(document, node.extensions, "KHR_lights_punctual", element);
  if (!extension.present()) return absl::OkStatus();
  STRATA_ASSIGN_OR_RETURN(const int index, extension.Index("light"));
  STRATA_ASSIGN_OR_RETURN(
      const tinygltf::Light* light,
      document.Find(document.model().lights, index, "light", extension.element() + ".light"));
  const std::string name = StrCat("extensions.KHR_lights_punctual.", ElementName("lights", index));
  STRATA_ASSIGN_OR_RETURN(const Rgb strength, StrengthOf(document, *light, name));
  if (light->range > 0)
    document.Warn(name + ".range", "light falls off by the square of the distance, without an end");
  const Vec3d position = to_world.Point({0, 0, 0});
  const Vec3d towards = Normalize(to_world.Vector({0, 0, 1}));
  LightDescription description;
  description.where = document.At(name);
  if (light->type == "directional") {
    const Vec3f direction = ToFloat(towards);
    if (!IsFinite(direction)) return document.Error(element, "its light has no direction");
    description.light = DistantLightDescription{direction, strength};
  } else if (light->type == "point") {
    description.light = PointLightDescription{position, strength};
  } else if (light->type == "spot") {
    const auto degrees = [](double radians) {
      return static_cast<float>(std::clamp(radians * 180 / std::numbers::pi, 0.0, 90.0));
    };
    const float outer = degrees(light->spot.outerConeAngle);
    const float inner = std::min(degrees(light->spot.innerConeAngle), outer);
    const Vec3f direction = ToFloat(Normalize(to_world.Vector({0, 0, -1})));
    if (!IsFinite(direction)) return document.Error(element, "its light has no direction");
    description.light = SpotLightDescription{position, direction, outer, inner, strength};
  } else {
    return document.Error(name + ".type",
                          StrCat("\"", light->type, "\" is none of directional, point and spot"));
  }
  if (!IsBlack(strength)) document.scene.lights.push_back(std::move(description));
  return absl::OkStatus();
}

}  // namespace strata
