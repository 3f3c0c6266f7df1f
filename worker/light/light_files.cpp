#include "worker/light/light_files.h"

#include "worker/light/ies.h"
#include "worker/light/placed_light.h"

namespace strata {

std::optional<std::string> LightImagePath(const LightDescription& light) {
  if (const auto* sky = std::get_if<ImageInfiniteLightDescription>(&light.light)) return sky->path;
  if (const auto* projection = std::get_if<ProjectionLightDescription>(&light.light))
    return projection->path;
  const auto* lamp = std::get_if<GoniometricLightDescription>(&light.light);
  return lamp && !IsIesFile(lamp->path) ? std::optional(lamp->path) : std::nullopt;
}

absl::Status CheckLightFile(const LightDescription& light, const FileSource& source) {
  if (const auto* sky = std::get_if<ImageInfiniteLightDescription>(&light.light)) {
    return sky->portal ? PortalImage::Load(*sky, source).status()
                       : EnvironmentImage::Load(*sky, source, false).status();
  }
  if (const auto* projection = std::get_if<ProjectionLightDescription>(&light.light))
    return Projection::Load(*projection, source).status();
  if (const auto* lamp = std::get_if<GoniometricLightDescription>(&light.light)) {
    STRATA_ASSIGN_OR_RETURN(const Diagram diagram,
                            Diagram::Load(lamp->path, lamp->mapping, source));
    return MakeGoniometricLight(*lamp, diagram).status();
  }
  return absl::OkStatus();
}

}  // namespace strata
