#pragma once

#include <string>

#include "worker/gltf/document.h"

namespace strata {

/// The camera `index` at a node, and the frame it was made for: glTF's looks along -z with y up.
/// The yfov of a perspective one spans the picture's height; xmag and ymag of an orthographic one
/// are half the picture's width and height in metres, and its rays start in the camera's plane. In
/// a picture of another shape than the file's both keep what the shorter edge shows.
absl::Status SetCamera(GltfDocument& document, int index, const Transform& to_world,
                       const std::string& element);

/// The node's own name or that of its camera, or the camera's index.
bool IsCameraCalled(const GltfDocument& document, const tinygltf::Node& node,
                    const std::string& wanted);

}  // namespace strata
