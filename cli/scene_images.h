#pragma once

#include "cli/job_options.h"

namespace strata {

/// Reads every image the scene names and throws it away, so that one a worker would stumble over is
/// found here. INVALID_ARGUMENT, one line "image: what is wrong, what to do"; what is wrong with an
/// image as an environment has the light's "file:line: " before it.
absl::Status CheckImages(const LoadedScene& loaded);

}  // namespace strata
