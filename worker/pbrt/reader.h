#pragma once

#include <string>

#include "worker/scene/file_source.h"
#include "worker/scene/scene_file.h"

namespace strata {

using PbrtScene = SceneFile;

/// Reads the pbrt-v4 file `scene_path` (a bundle path) and all it includes. PLY meshes are loaded,
/// several at a time; images are only located. Errors read "file:line: what is wrong, what to do"
/// and are INVALID_ARGUMENT, or NOT_FOUND for missing files.
absl::StatusOr<PbrtScene> ReadPbrt(const FileSource& source, const std::string& scene_path);

}  // namespace strata
