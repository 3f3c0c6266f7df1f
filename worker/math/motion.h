#pragma once

#include <optional>
#include <vector>

#include "worker/math/transform.h"

namespace strata {

/// Embree's limit on the pieces of a motion.
inline constexpr int kMaxMotionPieces = 128;

/// The affine maps of a motion from `start` to `end` at equal steps of time, start and end among
/// them: at least two, at most kMaxMotionPieces + 1. Between steps the map's elements change
/// linearly: rays and shading alike take it so.
///
/// As in PBRT (3rd ed., 2.9) each map is parted into translation, rotation and a symmetric stretch
/// by polar decomposition; rotations follow the shorter great arc of quaternions, the others
/// straight lines. There are as many steps as keep points within 2^-17 of their distance from the
/// object's origin on that way; turns above 1 radian reach the limit, and half a turn deviates by
/// 8e-5 of the distance. More than half a turn cannot be said by two maps.
///
/// None if a map is not affine or singular, or if one mirrors and the other does not.
std::optional<std::vector<Transform>> MotionSteps(const Transform& start, const Transform& end);

/// Where in the steps a time in [0, 1] lies: between `step` and the next, `fraction` of the way.
/// In float, as Embree reckons it.
struct MotionTime {
  int step = 0;
  float fraction = 0;

  MotionTime(float time, int pieces) {
    const float scaled = time * static_cast<float>(pieces);
    step = static_cast<int>(scaled);
    if (step > pieces - 1) step = pieces - 1;
    fraction = scaled - static_cast<float>(step);
  }
};

}  // namespace strata
