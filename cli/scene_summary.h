#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/job.h"
#include "worker/scene/scene_file.h"

namespace strata {

/// What a scene is made of, for `strata check`. Kinds are named as pbrt-v4 names them.
struct SceneSummary {
  using Counts = std::map<std::string, uint64_t>;
  Counts shapes;  ///< In the file, those of objects once.
  Counts materials, lights, textures;
  uint64_t triangles = 0;            ///< Stored: those of objects once.
  uint64_t instanced_triangles = 0;  ///< What the camera may see: objects as often as placed.
  uint64_t objects = 0, instances = 0;
  uint64_t files = 0, file_bytes = 0;
};

/// "900 of 1600 pixels see the background only, so no rays are traced there"
std::string BackgroundLine(int64_t background_pixels, int64_t all_pixels);
/// "2 objects, 1 material, 3 textures (2 images)"
std::string UnusedLine(const UnusedParts& unused);

/// Emissive shapes count among the lights as "area".
SceneSummary Summarize(const SceneDescription& scene);

/// Bytes of the film a coordinator keeps for this job: replicate means, moments and counts.
uint64_t FilmBytes(const JobSpec& spec);

}  // namespace strata
