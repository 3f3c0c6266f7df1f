#pragma once

#include "common/status.h"
#include "worker/scene/description.h"

namespace strata {

/// The surface that Loop's subdivision of a triangle mesh tends to (PBRT, 3rd ed., 3.8): `levels`
/// times each face becomes four, then all vertices are moved to the limit, where they get their
/// exact normals. Borders follow the cubic B-spline of their own vertices alone, and so take
/// its limit, where the book moves them by 1/5 instead of 1/6; extraordinary vertices are weighted
/// by Warren's beta. Normals are on the side from which faces are seen
/// counter-clockwise. The control mesh's own normals and uvs are not looked at.
///
/// INVALID_ARGUMENT for an index out of range, a mesh that is not a surface (an edge of more than
/// two faces, faces that meet in a point alone, two faces of opposite orientation), and for more
/// than 2^29 faces.
absl::StatusOr<TriangleMeshShape> LoopSubdivide(const TriangleMeshShape& control, int levels);

}  // namespace strata
