#pragma once

#include <vector>

#include "worker/gltf/document.h"
#include "worker/gltf/materials.h"

namespace strata {

/// The primitives of a mesh as shapes in the mesh's own space. Strips and fans become triangles;
/// points and lines are warned of and left out; without normals a mesh is flat (glTF 2.0, 3.7.2).
absl::StatusOr<std::vector<ShapeDescription>> MakeShapes(GltfDocument& document,
                                                         MaterialMaker& materials, int mesh);

}  // namespace strata
