#pragma once

#include <algorithm>
#include <vector>

#include "worker/light/light_bounds.h"

namespace strata {

/// What scatters between a point and the lamps: means over the channels, per scene unit.
struct Haze {
  float scattering = 0, extinction = 0;
};

/// The strongest lamps of a scene, around which media glow. Immutable.
class LampPlaces {
 public:
  static constexpr size_t kMost = 4;
  struct Place {
    Vec3f center;
    float radius2;  ///< Square of the lamp's radius: nearer, it is no brighter.
    float intensity;
  };

  LampPlaces() = default;
  explicit LampPlaces(std::vector<LightBounds> lamps) {
    std::stable_sort(lamps.begin(), lamps.end(), [](const LightBounds& a, const LightBounds& b) {
      return a.intensity > b.intensity;
    });
    for (size_t i = 0; i < std::min(lamps.size(), kMost); ++i)
      places_.push_back({lamps[i].Center(), 0.25f * LengthSquared(lamps[i].max - lamps[i].min),
                         lamps[i].intensity});
  }
  const std::vector<Place>& places() const { return places_; }

 private:
  std::vector<Place> places_;
};

}  // namespace strata
