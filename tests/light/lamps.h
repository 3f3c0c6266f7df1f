#pragma once

#include "tests/light/light_scene.h"

namespace strata {

/// Lamps of every kind, thrown about a box of 10 units: triangles, squares, spheres, disks and
/// points in turn.
SceneDescription ManyLamps(int count, uint64_t seed);

}  // namespace strata
