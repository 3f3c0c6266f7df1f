#pragma once

#include <string>
#include <vector>

#include "common/status.h"
#include "worker/math/transform.h"
#include "worker/math/vec.h"
#include "worker/scene/file_source.h"

// What lights take from their descriptions.

namespace strata {

struct LightImage {
  int width = 0, height = 0;
  std::vector<Rgb> pixels;  ///< Row 0 first, at the top; linear, times the scale.
};

/// INVALID_ARGUMENT with the path for an image that cannot be read, or that holds, once scaled, a
/// negative or non-finite value: light can be neither.
absl::StatusOr<LightImage> ReadLightImage(const std::string& path, float scale,
                                          const FileSource& source);

/// INVALID_ARGUMENT with the path for an image that is not square, as the equal-area layout is.
absl::Status CheckEqualArea(const LightImage& image, const std::string& path);

/// The light's x, y and z in world space, of unit length; may be left-handed. INVALID_ARGUMENT for
/// a transform that shears or is singular.
absl::StatusOr<Frame> LightAxes(const Transform& to_world);

}  // namespace strata
