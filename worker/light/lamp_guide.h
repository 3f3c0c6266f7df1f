#pragma once

#include <algorithm>
#include <optional>

#include "worker/bsdf/bsdf.h"
#include "worker/light/ball_guide.h"
#include "worker/light/mirror_guide.h"

namespace strata {

/// Lamps that chance finds too rarely on their ways by other surfaces.
struct LampImages {
  MirrorImages mirrors;
  BallImages balls;

  bool empty() const { return mirrors.empty() && balls.empty(); }
};

/// Directions from one point towards such lamps.
class LampGuide {
 public:
  /// Where no image can be seen the share is 0. Mirrors are for surfaces alone.
  void Start(const LampImages& images, const LightReceiver& receiver) {
    mirror_share_ = ball_share_ = 0;
    if (!images.mirrors.empty() && receiver.one_sided) {
      mirrors_.Start(images.mirrors, receiver);
      mirror_share_ = mirrors_.share();
    }
    if (!images.balls.empty()) {
      balls_.Start(images.balls, receiver.p);
      ball_share_ = balls_.share();
      mirror_share_ *= 1 - ball_share_;
    }
  }

  /// Part of the directions that is to be taken from here, below 1.
  float share() const { return mirror_share_ + ball_share_; }
  /// A direction, unit; none where the guide leads nowhere. The share must not be 0.
  std::optional<Vec3f> Sample(float u_image, Vec2f u) const {
    const float of_balls = ball_share_ / share();
    if (u_image < of_balls) return balls_.Sample(u_image / of_balls, u);
    constexpr float kBelowOne = 0x1.fffffep-1f;
    return mirrors_.Sample(std::min((u_image - of_balls) / (1 - of_balls), kBelowOne), u);
  }
  /// The density of a direction which is the guide's with probability share() and otherwise has
  /// `pdf`.
  float MixedPdf(float pdf, Vec3f w) const {
    float mixed = (1 - share()) * pdf;
    if (mirror_share_ > 0) mixed += mirror_share_ * mirrors_.Pdf(w);
    if (ball_share_ > 0) mixed += ball_share_ * balls_.Pdf(w);
    return mixed;
  }

 private:
  float mirror_share_ = 0, ball_share_ = 0;
  MirrorGuide mirrors_;
  BallGuide balls_;
};

/// A direction from `guide` or `bsdf`, by one-sample MIS (Veach 1997, 9.2.4; PBRT 2.2.3).
template <typename X>
std::optional<BsdfSample> SampleGuided(const X& bsdf, const Frame& frame, Vec3f wo,
                                       const LampGuide& guide, float u_lobe, Vec2f u) {
  const float share = guide.share();
  BsdfSample sample;
  if (u_lobe < share) {
    const std::optional<Vec3f> guided = guide.Sample(u_lobe / share, u);
    if (!guided) return std::nullopt;
    sample.wi = frame.ToLocal(*guided);
    sample.to_lamp = true;
  } else {
    constexpr float kBelowOne = 0x1.fffffep-1f;
    const std::optional<BsdfSample> own =
        Sample(bsdf, wo, std::min((u_lobe - share) / (1 - share), kBelowOne), u);
    if (!own) return std::nullopt;
    sample = *own;
    if (sample.delta) {
      sample.weight *= 1 / (1 - share);
      return sample;
    }
  }
  const BsdfValue value = EvalPdf(bsdf, wo, sample.wi);
  sample.pdf = guide.MixedPdf(value.pdf, frame.ToWorld(sample.wi));
  if (!(sample.pdf > 0)) return std::nullopt;
  sample.weight = value.f / sample.pdf;
  return sample;
}

/// Whether a guide may help: light is scattered far and wide.
inline bool IsWorthGuiding(const Bsdf& bsdf) {
  return std::holds_alternative<DiffuseBsdf>(bsdf) ||
         std::holds_alternative<CoatedDiffuseBsdf>(bsdf) ||
         std::holds_alternative<PhaseFunction>(bsdf);
}

}  // namespace strata
