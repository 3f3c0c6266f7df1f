#pragma once

#include <vector>

#include "common/status.h"
#include "worker/geometry/state.h"

namespace strata {

/// The instance without its object: its placement, that at the start if it moves, and then its
/// motion, which is added to `motions`. INVALID_ARGUMENT with its place for a map that is singular
/// or not affine, and for a motion that cannot be.
absl::StatusOr<Instance> PlaceInstance(const InstanceDescription& description,
                                       std::vector<InstanceMotion>* motions);

/// A moving instance as it is at one time, where Embree saw it.
struct MovedInstance {
  MovedInstance(const Instance& instance, const InstanceMotion& motion, float time);

  Instance instance;
  /// What its translation may differ by from that in Embree, which interpolates in float. What the
  /// linear part may differ by is in `instance.origin_error`.
  Vec3f translation_error;
};

}  // namespace strata
