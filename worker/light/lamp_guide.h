#pragma once

#include <algorithm>
#include <array>
#include <optional>

#include "worker/bsdf/bsdf.h"
#include "worker/light/ball_guide.h"
#include "worker/light/glow_guide.h"
#include "worker/light/mirror_guide.h"
#include "worker/sampling/choose.h"

namespace strata {

/// Lamps that chance finds too rarely, or their light.
struct LampImages {
  MirrorImages mirrors;
  BallImages balls;
  LampPlaces glows;  ///< If there are media that scatter.

  bool empty() const { return mirrors.empty() && balls.empty() && glows.places().empty(); }
};

/// Directions from one point towards such lamps.
class LampGuide {
 public:
  /// Where nothing is to be seen the share is 0. Mirrors are for surfaces alone.
  void Start(const LampImages& images, const LightReceiver& receiver, Haze haze) {
    shares_ = {};
    if (!images.mirrors.empty() && receiver.one_sided) {
      mirrors_.Start(images.mirrors, receiver);
      shares_[kMirrors] = mirrors_.share();
    }
    if (!images.glows.places().empty() && haze.scattering > 0) {
      glows_.Start(images.glows, receiver.p, haze);
      Put(kGlows, glows_.share());
    }
    if (!images.balls.empty()) {
      balls_.Start(images.balls, receiver.p);
      Put(kBalls, balls_.share());
    }
    share_ = shares_[kMirrors] + shares_[kGlows] + shares_[kBalls];
  }

  /// Part of the directions that is to be taken from here, below 1.
  float share() const { return share_; }
  /// A direction, unit; none where the guide leads nowhere. The share must not be 0.
  std::optional<Vec3f> Sample(float u_image, Vec2f u) const {
    float left = u_image * share_;
    const auto chooses = [&](Kind kind) {
      const float share = shares_[kind];
      if (left < share) {
        left = std::min(left / share, kBelowOne);
        return true;
      }
      left -= share;
      return false;
    };
    if (chooses(kBalls)) return balls_.Sample(left, u);
    if (chooses(kGlows)) return glows_.Sample(left, u);
    // What rounding has left over.
    if (!chooses(kMirrors) && !(shares_[kMirrors] > 0)) return std::nullopt;
    return mirrors_.Sample(std::min(left, kBelowOne), u);
  }
  /// The density of a direction which is the guide's with probability share() and otherwise has
  /// `pdf`.
  float MixedPdf(float pdf, Vec3f w) const {
    float mixed = (1 - share_) * pdf;
    if (shares_[kMirrors] > 0) mixed += shares_[kMirrors] * mirrors_.Pdf(w);
    if (shares_[kGlows] > 0) mixed += shares_[kGlows] * glows_.Pdf(w);
    if (shares_[kBalls] > 0) mixed += shares_[kBalls] * balls_.Pdf(w);
    return mixed;
  }

 private:
  enum Kind { kMirrors, kGlows, kBalls, kKinds };
  /// The others share what is left.
  void Put(Kind kind, float share) {
    for (float& other : shares_) other *= 1 - share;
    shares_[kind] = share;
  }

  std::array<float, kKinds> shares_ = {};
  float share_ = 0;
  MirrorGuide mirrors_;
  GlowGuide glows_;
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
