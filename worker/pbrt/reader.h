#pragma once

#include <string>
#include <vector>

#include "common/bundle.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"
#include "worker/scene/unused.h"

namespace strata {

/// A scene with what a person should know of it.
struct PbrtScene {
  SceneDescription scene;
  std::vector<SceneWarning> warnings;  ///< In file order; repeated ones are told once with a count.
  std::vector<std::string>
      files;           ///< Bundle paths of all files the scene needs, sorted, itself included.
  UnusedParts unused;  ///< What the file has beyond that: neither in `scene` nor in `files`.
};

/// Reads the pbrt-v4 file `scene_path` (a bundle path) and all it includes. PLY meshes are loaded,
/// several at a time; images are only located. Errors read "file:line: what is wrong, what to do"
/// and are INVALID_ARGUMENT, or NOT_FOUND for missing files.
absl::StatusOr<PbrtScene> ReadPbrt(const FileSource& source, const std::string& scene_path);

/// Digests the scene's files under `root`.
absl::StatusOr<Bundle> MakeBundle(const FileSource& source, const std::string& scene_path,
                                  const std::vector<std::string>& files);

}  // namespace strata
