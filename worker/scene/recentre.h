#pragma once

#include "worker/math/box.h"
#include "worker/scene/description.h"

namespace strata {

/// A box around the shape placed by `to`; empty for a mesh without vertices.
Box BoundsOf(const ShapeGeometry& shape, const Transform& to);

/// A box around all shapes and instances, in the file's world; empty for a scene without any.
Box BoundsOf(const SceneDescription& scene);

/// Moves the world's origin to where the camera is, or to the nearest point of the scene's bounds
/// if it stands outside of them, so that what follows may round to float: in float a scene of unit
/// size a million units from the origin has steps of a sixteenth. Returns the new origin in the
/// file's world. (PBRT 5.1.1 renders in such a space, too.)
///
/// The origin is a multiple of 2^-20 of the scene's extent, or of a little less: coordinates of few
/// digits stay exact, and planes at them stay on the border of a solid texture's cells.
Vec3d Recentre(SceneDescription& scene);

}  // namespace strata
