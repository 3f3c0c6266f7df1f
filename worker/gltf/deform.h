#pragma once

#include <optional>
#include <string>
#include <vector>

#include "worker/gltf/document.h"

// Vertices that are not where their mesh has them: morph targets (glTF 2.0, 3.7.2.2), then skins
// (3.7.3). Animations are not played, so both are in the pose that nodes and weights say.

namespace strata {

/// The pose of one appearance of a mesh.
struct MeshPose {
  std::vector<double> weights;  ///< Of the mesh's morph targets; those not given are 0.
  /// From the mesh's space to the world, by joint; empty: the mesh has no skin. Vertices of a skin
  /// are in the world's space: the transform of their node does not count.
  std::vector<Transform> joints;
};

/// The joints of skin `index` (named by `element`), where the nodes of the scene stand as in
/// `node_to_world`. None, and a warning, when a joint is not in the scene.
absl::StatusOr<std::optional<std::vector<Transform>>> JointsOf(
    GltfDocument& document, int index, const std::vector<std::optional<Transform>>& node_to_world,
    const std::string& element);

/// Moves positions and normals (if there are any) of a primitive as the pose says. Errors name the
/// accessor; `element` is the primitive.
absl::Status ApplyPose(GltfDocument& document, const tinygltf::Primitive& primitive,
                       const MeshPose& pose, const std::string& element, TriangleMeshShape* mesh);

}  // namespace strata
