#pragma once

#include <optional>

#include "worker/gltf/accessors.h"
#include "worker/gltf/materials.h"

namespace strata {

/// More than this do not fit an image of the largest size.
inline constexpr size_t kMaxColoredTriangles = size_t{32768} * 32768;

/// The colour of all vertices, where they have the same.
std::optional<VertexColor> ConstantColor(const FloatAttribute& colors);

/// Colours of vertices, interpolated linearly over each triangle, as textures: each triangle has
/// 2x2 texels of a float image of their own, at whose centres lie three corners; the fourth texel
/// is such that the bilinear lookup is linear. Gives the mesh, in which no two triangles share a
/// vertex then, the texture coordinates of that image: as its second ones if it has some already.
VertexColor PaintTriangles(const FloatAttribute& colors, const SourceLocation& where,
                           TriangleMeshShape* mesh, TextureMaker& textures);

}  // namespace strata
