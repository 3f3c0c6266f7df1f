#pragma once

#include "common/status.h"
#include "worker/pbrt/context.h"

namespace strata {

/// Reads the PLY file that the shape is yet to be read from, if there is one. The file becomes one
/// the scene needs. Errors are those of ParsePly and CheckPlacement, located at the shape.
absl::Status ReadMeshFile(ShapeDescription* shape, ReadContext& context);

/// The same for all shapes of the scene, as many files at a time as there are cores; the error is
/// that of the first shape that has one. Shapes without faces are left out, with a warning.
absl::Status ReadMeshFiles(ReadContext& context);

}  // namespace strata
