#pragma once

#include <cstdint>

namespace strata {

/// What a scene may ask of the fast kernel. It is compiled for a few sets of these, in which what
/// is not of the set is left out of the code, and the smallest that covers the scene traces it: the
/// same bits for less time.
enum Features : uint32_t {
  kNoFeatures = 0,
  kEnvironments = 1,    ///< Lights that rays which leave the scene see.
  kAlphaMasks = 2,      ///< Rays have ids.
  kLampImages = 4,      ///< Directions may come from guides.
  kOtherMaterials = 8,  ///< Not Lambertian, or not the same all over the surface.
  kManyLights = 16,     ///< More than one: there is a choice to make.
  kMedia = 32,          ///< Any but empty space. With kOtherMaterials alone.
  kAllFeatures = 63
};

}  // namespace strata
