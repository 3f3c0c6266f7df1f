#pragma once

#include <string>
#include <vector>

#include "common/bundle.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"
#include "worker/scene/unused.h"

namespace strata {

/// A scene with what a person should know of it.
struct SceneFile {
  SceneDescription scene;
  std::vector<SceneWarning> warnings;  ///< In file order; repeated ones are told once with a count.
  std::vector<std::string>
      files;           ///< Bundle paths of all files the scene needs, sorted, itself included.
  UnusedParts unused;  ///< What the file has beyond that: neither in `scene` nor in `files`.
};

/// Reads the scene `scene_path` (a bundle path), glTF 2.0 where the name ends in .gltf or .glb,
/// pbrt-v4 otherwise, and does what the job's options say. Errors name the file and the place in it
/// and are INVALID_ARGUMENT, or NOT_FOUND for missing files.
absl::StatusOr<SceneFile> ReadSceneFile(const FileSource& source, const std::string& scene_path,
                                        const SceneOptions& options = {});

/// Digests the scene's files.
absl::StatusOr<Bundle> MakeBundle(const FileSource& source, const std::string& scene_path,
                                  const std::vector<std::string>& files,
                                  const SceneOptions& options = {});

}  // namespace strata
