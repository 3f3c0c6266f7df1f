#pragma once

#include <algorithm>
#include <array>

#include "worker/light/light_bounds.h"
#include "worker/light/mirror_images.h"

namespace strata {

/// Directions from one point towards the images of lamps in metal rectangles. An image is seen
/// where the reflector mirrors it, blurred by the reflector's roughness and the lamp's size: on the
/// reflector its density falls off from there along both edges as the slopes of GGX do
/// ((1 + x^2)^(-3/2) in one dimension), cut off at the edges.
class MirrorGuide {
 public:
  /// Makes a guide for `receiver`; where no image can be seen its share is 0.
  void Start(const MirrorImages& images, const LightReceiver& receiver);

  /// Part of the directions that is to be taken from here, below 1.
  float share() const { return share_; }
  /// A direction, unit. The share must not be 0.
  Vec3f Sample(float u_image, Vec2f u) const;
  /// Its density, per solid angle.
  float Pdf(Vec3f w) const;

 private:
  static constexpr size_t kMaxGroups = MirrorImages::kMaxImages / kLanes;
  /// Where images are all there is.
  static constexpr float kMaxShare = 0.8f;
  /// An image that a diffuse surface's own directions meet with this probability counts half.
  static constexpr float kEnoughChance = 0.02f;
  /// Where images, left to chance, would have this variance in units of the square of what lamps
  /// bring directly, half of kMaxShare goes to them.
  static constexpr float kHalfNoise = 0.2f;
  static constexpr float kHuge = 1e30f;

  /// Along one edge of each reflector.
  struct Axis {
    FloatLanes middle, scale;
    FloatLanes low, high;  ///< Slope(x) at the ends.

    Axis() = default;
    Axis(FloatLanes at, FloatLanes width, FloatLanes length) : middle(at) {
      // An image beyond the reflector is seen by its tail. Floats must tell the tail's ends apart.
      const FloatLanes beyond = Max(Max(-at, at - length), FloatLanes{});
      scale = Max(width, 0.25f * beyond);
      low = Slope(-at / scale);
      high = Slope((length - at) / scale);
    }
    /// Twice the distribution function, minus 1.
    static FloatLanes Slope(FloatLanes x) { return x / Sqrt(1 + x * x); }
    FloatLanes Mass() const { return 0.5f * (high - low); }
    FloatLanes Density(FloatLanes at) const {
      const FloatLanes x = (at - middle) / scale, y = 1 + x * x;
      return 1 / (y * Sqrt(y) * scale * (high - low));
    }
    float Sample(int lane, float length, float u) const {
      const float c = low[lane] + (high[lane] - low[lane]) * u;
      const float x = c / std::sqrt(std::max(1 - c * c, 1e-12f));
      return std::clamp(middle[lane] + scale[lane] * x, 0.0f, length);
    }
  };
  struct View {
    FloatLanes height;  ///< Of the point over the reflectors.
    Axis axis1, axis2;
    FloatLanes weight;  ///< What the image brings, unless chance finds it anyway.
    FloatLanes noise;   ///< Its variance if it is left to chance.
  };

  static View ViewOf(const MirrorImages::Images& images, const LightReceiver& receiver);
  static float DirectLight(const MirrorImages& images, const LightReceiver& receiver);

  const MirrorImages* images_ = nullptr;
  Vec3f p_;
  float share_ = 0;
  float total_ = 0;  ///< Of the weights.
  std::array<View, kMaxGroups> views_;
};

inline MirrorGuide::View MirrorGuide::ViewOf(const MirrorImages::Images& m,
                                             const LightReceiver& receiver) {
  const Vec3Lanes n = SameVector(receiver.n);
  const Vec3Lanes from_corner = SameVector(receiver.p) - m.corner;
  const Vec3Lanes to_image = m.center - SameVector(receiver.p);
  const FloatLanes height = Dot(m.normal, from_corner);
  const FloatLanes distance2 = LengthSquared(to_image), distance = Sqrt(distance2);
  // Where the straight line to the image meets the reflector, and how far it is from there to the
  // point and to the lamp.
  const FloatLanes part = height / (height + m.height);
  const FloatLanes to_point = distance * part, to_lamp = distance - to_point;
  const FloatLanes cosine = (height + m.height) / distance;
  const Vec3Lanes at = from_corner + to_image * part;

  // The half vector's slope is alpha wide; a step on the reflector turns it by half of what the
  // two directions turn, more across the plane of incidence than in it.
  const FloatLanes blur = 2 * m.alpha * to_point * to_lamp / distance, spot = m.radius * part;
  const FloatLanes in = (blur * blur + spot * spot) / (cosine * cosine);
  const FloatLanes across = blur * blur * cosine * cosine + spot * spot;
  const FloatLanes along1 = Dot(to_image, m.unit1), along2 = Dot(to_image, m.unit2);
  const FloatLanes tangential2 = along1 * along1 + along2 * along2;
  const FloatLanes in1 = tangential2 > 0 ? along1 * along1 / tangential2 : SameFloat(0.5f);
  View view;
  view.height = height;
  view.axis1 = Axis(Dot(at, m.unit1), Sqrt(in * in1 + across * (1 - in1)), m.length1);
  view.axis2 = Axis(Dot(at, m.unit2), Sqrt(in * (1 - in1) + across * in1), m.length2);

  // The rectangle's corner that is farthest along n must lie before the point.
  const Vec3Lanes far = m.unit1 * (Dot(n, m.unit1) > 0 ? m.length1 : FloatLanes{}) +
                        m.unit2 * (Dot(n, m.unit2) > 0 ? m.length2 : FloatLanes{}) - from_corner;
  constexpr float kLeastCosine = 0.05f;
  const FloatLanes seen_cosine = Max(Dot(n, to_image) / distance, SameFloat(kLeastCosine));
  const FloatLanes mass1 = view.axis1.Mass(), mass2 = view.axis2.Mass();
  const FloatLanes light = m.strength * seen_cosine * mass1 * mass2 / distance2;
  // Of meeting the part of the reflector where the image is, four scales wide if it is all there.
  const FloatLanes area = 4 * view.axis1.scale * view.axis2.scale * mass1 * mass2;
  const FloatLanes chance = kInvPi * area * cosine * seen_cosine / (to_point * to_point);
  const FloatLanes weight = light / (1 + chance * (1 / kEnoughChance));
  const FloatLanes noise = light * weight / chance;
  const MaskLanes valid = (height > 0) & (Dot(n, far) > 0) & (weight > 0) & (noise < kHuge);
  view.weight = valid ? weight : FloatLanes{};
  view.noise = valid ? noise : FloatLanes{};
  return view;
}

/// What the lamps themselves bring if nothing is in the way.
inline float MirrorGuide::DirectLight(const MirrorImages& images, const LightReceiver& receiver) {
  float sum = 0;
  for (const MirrorImages::Lamps& lamps : images.lamps()) {
    const Vec3Lanes to_lamp = lamps.center - SameVector(receiver.p);
    const FloatLanes distance2 = LengthSquared(to_lamp);
    const FloatLanes cosine = Dot(SameVector(receiver.n), to_lamp) / Sqrt(distance2);
    const FloatLanes light = lamps.intensity * Max(cosine, FloatLanes{}) / distance2;
    for (int lane = 0; lane < kLanes; ++lane)
      if (light[lane] > 0) sum += light[lane];
  }
  return sum;
}

inline void MirrorGuide::Start(const MirrorImages& images, const LightReceiver& receiver) {
  images_ = &images;
  p_ = receiver.p;
  total_ = 0;
  float noise = 0;
  for (size_t i = 0; i < images.images().size(); ++i) {
    views_[i] = ViewOf(images.images()[i], receiver);
    for (int lane = 0; lane < kLanes; ++lane) {
      total_ += views_[i].weight[lane];
      noise += views_[i].noise[lane];
    }
  }
  const float direct = DirectLight(images, receiver);
  share_ = total_ > 0 ? kMaxShare * noise / (noise + kHalfNoise * direct * direct) : 0;
}

inline Vec3f MirrorGuide::Sample(float u_image, Vec2f u) const {
  // The last with any weight, should rounding lead beyond it.
  size_t group = 0;
  int lane = 0;
  float left = u_image * total_;
  for (size_t i = 0; i < images_->images().size() && left >= 0; ++i) {
    for (int k = 0; k < kLanes && left >= 0; ++k) {
      const float weight = views_[i].weight[k];
      if (!(weight > 0)) continue;
      group = i;
      lane = k;
      left -= weight;
    }
  }
  const MirrorImages::Images& m = images_->images()[group];
  const View& view = views_[group];
  const float at1 = view.axis1.Sample(lane, m.length1[lane], u.x);
  const float at2 = view.axis2.Sample(lane, m.length2[lane], u.y);
  return Normalize(m.corner.Get(lane) - p_ + m.unit1.Get(lane) * at1 + m.unit2.Get(lane) * at2);
}

inline float MirrorGuide::Pdf(Vec3f w) const {
  const Vec3Lanes direction = SameVector(w);
  FloatLanes sum = {};
  for (size_t i = 0; i < images_->images().size(); ++i) {
    const MirrorImages::Images& m = images_->images()[i];
    const View& view = views_[i];
    const FloatLanes cosine = -Dot(m.normal, direction);
    const FloatLanes distance = view.height / cosine;
    const Vec3Lanes at = SameVector(p_) - m.corner + direction * distance;
    const FloatLanes at1 = Dot(at, m.unit1), at2 = Dot(at, m.unit2);
    const MaskLanes inside = (view.weight > 0) & (cosine > 0) & (at1 >= 0) & (at1 <= m.length1) &
                             (at2 >= 0) & (at2 <= m.length2);
    const FloatLanes pdf =
        view.axis1.Density(at1) * view.axis2.Density(at2) * distance * distance / cosine;
    sum += inside ? view.weight * pdf : FloatLanes{};
  }
  float total = 0;
  for (int lane = 0; lane < kLanes; ++lane) total += sum[lane];
  return total / total_;
}

}  // namespace strata
