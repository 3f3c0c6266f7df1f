#pragma once

#include <absl/container/inlined_vector.h>

#include <optional>

#include "worker/light/ball_images.h"

namespace strata {

/// Directions from one point by a ball to its lamp: mostly to a uniform point of the lamp, by one
/// of the paths there are; else any direction to the ball, so that no weight is singular where
/// paths meet.
class BallGuide {
 public:
  void Start(const BallImages& images, Vec3f p);

  /// As MirrorGuide has it.
  float share() const { return share_; }
  /// None where the chosen point of the lamp is not seen by the ball.
  std::optional<Vec3f> Sample(float u_image, Vec2f u) const;
  float Pdf(Vec3f w) const;

 private:
  struct View {
    const BallImage* image;
    BallStrengths::ByChords weights;
    float weight;  ///< Their sum.
    Vec3f axis;    ///< Of the cone that the ball fills,
    float one_minus_cos;
  };

  Vec3d p_;
  float share_ = 0, total_ = 0;  ///< The latter of the views' weights.
  absl::InlinedVector<View, BallImages::kMaxImages> views_;
};

}  // namespace strata
