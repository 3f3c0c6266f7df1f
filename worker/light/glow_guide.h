#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "worker/light/lamp_places.h"
#include "worker/math/elementary.h"
#include "worker/sampling/choose.h"

namespace strata {

/// Directions from one point to the glow of lamps in the medium around it. A ray that passes a
/// lamp at an angle theta sees a glow of 1 / sin(theta): the angle is uniform.
class GlowGuide {
 public:
  void Start(const LampPlaces& lamps, Vec3f p, Haze haze) {
    count_ = 0;
    total_ = 0;
    float glow = 0, intensity = 0;
    for (const LampPlaces::Place& place : lamps.places()) {
      const Vec3f to_lamp = place.center - p;
      const float distance2 = LengthSquared(to_lamp), distance = std::sqrt(distance2);
      if (!(distance2 > place.radius2)) continue;
      const float depth = haze.extinction * distance;
      Lamp& lamp = lamps_[count_++];
      lamp.axis = to_lamp * (1 / distance);
      lamp.weight = place.intensity / distance * Exp(-depth);
      total_ += lamp.weight;
      // Of what a lamp brings from its own place most glows at one optical depth.
      glow += lamp.weight * haze.scattering * distance;
      intensity += place.intensity / distance;
    }
    constexpr float kMostShare = 0.4f, kE = 2.7182818f;
    share_ = intensity > 0 ? kMostShare * kE * glow / intensity : 0;
  }

  /// As MirrorGuide has it.
  float share() const { return share_; }
  Vec3f Sample(float u_lamp, Vec2f u) const {
    float left = u_lamp * total_;
    const size_t i = ChooseByWeight(
        count_, [&](size_t n) { return lamps_[n].weight; }, &left);
    const auto [sin, cos] = SinCos2Pi(0.5f * u.x);
    const auto [sin_phi, cos_phi] = SinCos2Pi(u.y);
    return Frame::FromNormal(lamps_[i].axis).ToWorld({sin * cos_phi, sin * sin_phi, cos});
  }
  float Pdf(Vec3f w) const {
    // Sines this small are drawn once in three millions.
    constexpr float kLeastSine = 1e-6f;
    float sum = 0;
    for (size_t i = 0; i < count_; ++i)
      sum += lamps_[i].weight / std::max(Length(Cross(lamps_[i].axis, w)), kLeastSine);
    return 0.5f * kInvPi * kInvPi * sum / total_;
  }

 private:
  struct Lamp {
    Vec3f axis;
    float weight;
  };
  std::array<Lamp, LampPlaces::kMost> lamps_;
  size_t count_ = 0;
  float share_ = 0, total_ = 0;
};

}  // namespace strata
