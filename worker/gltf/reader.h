#pragma once

#include <string>
#include <string_view>

#include "worker/scene/file_source.h"
#include "worker/scene/scene_file.h"

namespace strata {

/// Whether the name ends in .gltf or .glb.
bool IsGltfPath(std::string_view path);

/// Reads a glTF 2.0 file, text or binary, and the buffers it names; images are located, or kept as
/// bytes where they are embedded. What is read, warned of and refused: docs/scene-support.md. World
/// and units are the file's: +y up, right-handed, metres; photometric numbers are taken as
/// radiometric ones (lights.h).
///
/// A file without camera gets one that frames it, one without light a constant environment of
/// radiance 1, both said in a warning. `options.camera` is a viewpoint, or the name or index of one
/// of the file's cameras; with `options.environment` no light is added for want of one.
///
/// Errors read "file:element: what is wrong, what to do", the element as in
/// "meshes[2].primitives[0]", and are INVALID_ARGUMENT, or NOT_FOUND for missing files.
absl::StatusOr<SceneFile> ReadGltf(const FileSource& source, const std::string& scene_path,
                                   const SceneOptions& options = {});

}  // namespace strata
