#pragma once

#include <functional>
#include <string>

#include "worker/gltf/document.h"

namespace strata {

/// A node as it stands in the world.
struct PlacedNode {
  const tinygltf::Node* node;
  int index;
  std::string element;
  Transform to_world;
};

/// Calls `visit` with every node of the default scene, parents first, children in order.
/// INVALID_ARGUMENT for a node that is its own ancestor or has two parents, and for a transform
/// that is none. Ends with the first error of `visit`.
absl::Status VisitNodes(GltfDocument& document,
                        const std::function<absl::Status(const PlacedNode&)>& visit);

/// The transforms of EXT_mesh_gpu_instancing in the node's space; the identity without it.
absl::StatusOr<std::vector<Transform>> InstancesOf(const GltfDocument& document,
                                                   const PlacedNode& placed);

}  // namespace strata
