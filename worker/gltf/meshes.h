#pragma once

#include <vector>

#include "worker/gltf/deform.h"
#include "worker/gltf/document.h"
#include "worker/gltf/materials.h"

namespace strata {

/// The primitives of a mesh in a pose, as shapes in the mesh's own space, or in the world's if the
/// pose has joints. Strips and fans become triangles;
/// points and lines are warned of and left out; without normals a mesh is flat (glTF 2.0, 3.7.2).
absl::StatusOr<std::vector<ShapeDescription>> MakeShapes(GltfDocument& document,
                                                         MaterialMaker& materials, int mesh,
                                                         const MeshPose& pose);

}  // namespace strata
