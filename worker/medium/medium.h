#pragma once

#include "worker/math/elementary_lanes.h"
#include "worker/math/vec.h"

namespace strata {

/// A homogeneous medium (PBRT 11.1 and 11.4), as rays ask for it. Coefficients are per scene unit.
struct Medium {
  Rgb extinction;  ///< Absorption and scattering: radiance falls off by it.
  Rgb scattering;
  /// Distances to the next scattering are exponential with it: the extinction, or 0 in a medium
  /// that does not scatter, which is crossed by all and weighs on their throughput alone.
  Rgb flight;
  Rgb emission;  ///< Radiance that a unit of length adds.
};

/// e^(-coefficient length) of each channel. A length may be infinite: what does not fade is
/// 1 still.
inline Rgb Fading(Rgb coefficient, float length) {
  const auto fading = [&](float c) { return c > 0 ? Exp(-c * length) : 1.0f; };
  return {fading(coefficient.r), fading(coefficient.g), fading(coefficient.b)};
}

/// Of each lane.
inline RgbLanes Fading(RgbLanes coefficient, FloatLanes length) {
  const auto fading = [&](FloatLanes c) { return c > 0 ? Exp(-c * length) : SameFloat(1); };
  return {fading(coefficient.r), fading(coefficient.g), fading(coefficient.b)};
}

/// What a stretch of the medium adds to a ray that comes out of it.
inline Rgb EmissionAlong(const Medium& medium, float length) {
  const auto sum = [&](float emission, float extinction) {
    return emission > 0 ? emission * -Expm1(-extinction * length) / extinction : 0.0f;
  };
  return {sum(medium.emission.r, medium.extinction.r), sum(medium.emission.g, medium.extinction.g),
          sum(medium.emission.b, medium.extinction.b)};
}

}  // namespace strata
