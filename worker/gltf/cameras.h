#pragma once

#include <string>

#include "worker/gltf/document.h"

namespace strata {

/// The camera `index` at a node, and the frame it was made for: glTF's looks along -z with y up,
/// and its yfov spans the picture's height, here that of its shorter edge where the picture is
/// upright.
absl::Status SetCamera(GltfDocument& document, int index, const Transform& to_world,
                       const std::string& element);

/// The node's own name or that of its camera, or the camera's index.
bool IsCameraCalled(const GltfDocument& document, const tinygltf::Node& node,
                    const std::string& wanted);

}  // namespace strata
