#pragma once

#include <cstdint>

#include "worker/scene/description.h"

namespace strata {

/// What a scene file defines and no picture of it can show.
struct UnusedParts {
  uint64_t objects = 0;    ///< Placed by no instance.
  uint64_t materials = 0;  ///< Of no shape that is left.
  uint64_t textures = 0;   ///< Of nothing that is left; constants are not counted.
  uint64_t images = 0;     ///< Those of the textures that are image files.

  bool Any() const { return objects + materials + textures > 0; }
};

/// Takes them out of the description and renumbers the rest in its order. All ids in it are valid.
/// Material 0 stays. Media that are
/// nowhere go, too, and are not counted.
UnusedParts RemoveUnused(SceneDescription* scene);

}  // namespace strata
