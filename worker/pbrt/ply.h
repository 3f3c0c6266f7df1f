#pragma once

#include <string_view>

#include "common/status.h"
#include "worker/scene/description.h"

namespace strata {

/// Reads the bytes of a PLY file (G. Turk, The PLY Polygon File Format, 1994): ASCII and binary of
/// both byte orders; elements "vertex" (x y z, optional nx ny nz, optional u v under any of their
/// usual names) and "face" (vertex_indices; polygons become fans of triangles). Other elements and
/// properties are skipped.
///
/// INVALID_ARGUMENT says what is malformed: the header, counts the bytes cannot hold, a truncated
/// body, values that are not finite, indices out of range, faces of fewer than three corners.
/// Memory never exceeds a small multiple of the file's size.
absl::StatusOr<TriangleMeshShape> ParsePly(std::string_view bytes);

}  // namespace strata
