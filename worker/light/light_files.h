#pragma once

#include <optional>
#include <string>

#include "common/status.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

// What a client looks at before it sends a scene away.

namespace strata {

/// The image that the light is made of, if it is; IES files are none.
std::optional<std::string> LightImagePath(const LightDescription& light);

/// What LightSet::Build would say of the light's file, without the light's place in the scene.
absl::Status CheckLightFile(const LightDescription& light, const FileSource& source);

}  // namespace strata
