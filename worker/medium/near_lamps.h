#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/light/lamp_places.h"
#include "worker/math/elementary.h"
#include "worker/sampling/choose.h"

namespace strata {

/// Distances along a stretch of a ray in proportion to what the lamps bring there: equiangular
/// sampling (Kulla and Fajardo 2012, "Importance Sampling Techniques for Path Tracing in
/// Participating Media", 3) of several lamps.
class NearLamps {
 public:
  /// Of a stretch of `length` from `origin` in the unit `direction`, where light fades by
  /// `extinction`.
  NearLamps(const LampPlaces& lamps, Vec3f origin, Vec3f direction, float length,
            float extinction) {
    float unfaded = 0;
    for (const LampPlaces::Place& place : lamps.places()) {
      Lamp& lamp = lamps_[count_++];
      const Vec3f to_lamp = place.center - origin;
      lamp.nearest = Dot(to_lamp, direction);
      const Vec3f across = to_lamp - direction * lamp.nearest;
      lamp.height2 = std::max(LengthSquared(across) + place.radius2, 1e-12f);
      lamp.height = std::sqrt(lamp.height2);
      lamp.begin = Atan2(-lamp.nearest, lamp.height);
      lamp.angle = Atan2(length - lamp.nearest, lamp.height) - lamp.begin;
      const float way = std::clamp(lamp.nearest, 0.0f, length) + lamp.height;
      const float brings = place.intensity * lamp.angle / lamp.height;
      unfaded += brings;
      lamp.share = brings * Exp(-extinction * way);
      total_ += lamp.share;
    }
    part_ = unfaded > 0 ? kMostPart * std::min(2.7182818f * total_ / unfaded, 1.0f) : 0;
    length_ = length;
  }

  /// Part of the distances that should be drawn from here: less where lamps are behind much of
  /// the medium.
  float part() const { return part_; }
  /// A distance in [0, length]. The part must not be 0.
  float Sample(float u) const {
    float left = u * total_;
    const Lamp& lamp = lamps_[ChooseByWeight(
        count_, [&](size_t i) { return lamps_[i].share; }, &left)];
    const float angle = lamp.begin + lamp.angle * std::min(left / lamp.share, 1.0f);
    return std::clamp(lamp.nearest + lamp.height * Tan(angle), 0.0f, length_);
  }
  float Pdf(float t) const {
    float sum = 0;
    for (size_t i = 0; i < count_; ++i) {
      const Lamp& lamp = lamps_[i];
      const float along = t - lamp.nearest;
      sum += lamp.share * lamp.height / (lamp.angle * (lamp.height2 + along * along));
    }
    return sum / total_;
  }

 private:
  static constexpr float kMostPart = 0.7f;
  struct Lamp {
    float nearest, height, height2;  ///< Where the ray is nearest to it, and how far off.
    float begin, angle;              ///< As seen from it.
    float share;
  };

  std::array<Lamp, LampPlaces::kMost> lamps_;
  size_t count_ = 0;
  float total_ = 0, part_ = 0, length_;
};

}  // namespace strata
