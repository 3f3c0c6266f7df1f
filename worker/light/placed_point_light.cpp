#include <cmath>
#include <numbers>

#include "worker/light/light_input.h"
#include "worker/light/placed_light.h"
#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"

// Lights that shine from a point.

namespace strata {

PlacedLight MakePointLight(const PointLightDescription& description) {
  const Vec3f position = ToFloat(description.position);
  const double intensity = Luminance(description.intensity);
  return {PointLight{position, description.intensity},
          {position, position},
          intensity,
          4 * std::numbers::pi * intensity};
}

PlacedLight MakeSpotLight(const SpotLightDescription& description) {
  const Vec3f position = ToFloat(description.position);
  const double start = VersineOfDegrees(description.falloff_start);
  const double end = VersineOfDegrees(description.cone_angle);
  const double falloff = VersineOfDegrees(description.cone_angle - description.falloff_start);
  const double intensity = Luminance(description.intensity);
  return {SpotLight{position, description.direction, description.intensity,
                    static_cast<float>(start), static_cast<float>(end)},
          {.min = position,
           .max = position,
           .axis = description.direction,
           .cos_spread = static_cast<float>(1 - start),
           .cos_emit = static_cast<float>(1 - falloff)},
          intensity,
          intensity * FalloffIntegral(start, end)};
}

PlacedLight MakeProjectionLight(const ProjectionLightDescription& description,
                                const Projection& projection) {
  const Vec3f position = ToFloat(description.to_world.Point({0, 0, 0}));
  const double x = projection.tan_x, y = projection.tan_y;
  const double solid_angle = 4 * Atan2(x * y, std::sqrt(1 + x * x + y * y));
  const double power = Luminance(projection.power);
  return {ProjectionLight{position, &projection},
          {.min = position,
           .max = position,
           .axis = projection.axes.z,
           .cos_spread = projection.CosCorner(),
           .cos_emit = 1},
          power / solid_angle,
          power};
}

absl::StatusOr<PlacedLight> MakeGoniometricLight(const GoniometricLightDescription& description,
                                                 const Diagram& diagram) {
  STRATA_ASSIGN_OR_RETURN(const Frame light, LightAxes(description.to_world));
  const Vec3f position = ToFloat(description.to_world.Point({0, 0, 0}));
  Rgb intensity = description.intensity;
  if (description.power) {
    const double own = 4 * std::numbers::pi * diagram.mean * Luminance(intensity);
    intensity *= static_cast<float>(*description.power / own);
    if (!IsFinite(intensity))
      return absl::InvalidArgumentError(
          absl::StrCat(description.path,
                       ": the diagram is black or too dark to be given a "
                       "\"power\"; leave that out"));
  }
  const double mean = diagram.mean * Luminance(intensity);
  // The diagram's third axis is the light's second.
  return PlacedLight{GoniometricLight{position, intensity, {light.x, light.z, light.y}, &diagram},
                     {position, position},
                     mean,
                     4 * std::numbers::pi * mean};
}

}  // namespace strata
