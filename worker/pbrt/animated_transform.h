#pragma once

#include <optional>

#include "worker/math/transform.h"

namespace strata {

/// The current transform of a pbrt file at the start and at the end of motion.
struct AnimatedTransform {
  Transform start, end;

  bool Moves() const { return start != end; }
  /// The second of both as descriptions hold it: none if nothing moves.
  std::optional<Transform> MovedEnd() const {
    return Moves() ? std::optional<Transform>(end) : std::nullopt;
  }
  /// None if one is singular.
  std::optional<AnimatedTransform> Inverse() const {
    const std::optional<Transform> a = start.Inverse(), b = end.Inverse();
    if (!a || !b) return std::nullopt;
    return AnimatedTransform{*a, *b};
  }
};

}  // namespace strata
