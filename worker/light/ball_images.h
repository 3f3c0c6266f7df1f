#pragma once

#include <array>
#include <vector>

#include "worker/bsdf/material.h"
#include "worker/light/ball_paths.h"
#include "worker/light/light_set.h"

namespace strata {

/// A full sphere of a scene description.
struct Ball {
  Vec3d center;
  double radius = 0;
  MaterialId material = 0;
};
/// Those in the world (not in instances) under similarities, without masks or emission.
std::vector<Ball> FindBalls(const SceneDescription& scene);

/// How strongly points see a lamp in a ball by paths of each number of chords.
class BallStrengths {
 public:
  using ByChords = std::array<float, kMaxChords + 1>;

  explicit BallStrengths(const LampInBall& lamp);
  /// Of the most of the nearest points looked at, relative to the lamp seen directly.
  const ByChords& At(Vec3d p) const;

 private:
  static constexpr int kDistances = 32, kAngles = 64;

  Vec3d center_, to_lamp_;  ///< The latter is unit.
  double radius_;
  std::vector<ByChords> cells_;  ///< By radius over distance, and by angle to the lamp.
};

struct BallImage {
  LampInBall lamp;
  BallStrengths strengths;
};

/// The small lamps that paths from a point by a smooth ball of glass find too rarely. Guides
/// directions (BallGuide) and changes no expectation. Immutable.
class BallImages {
 public:
  static constexpr size_t kMaxImages = 4;
  BallImages() = default;
  /// Of kMaxImages lamps at most.
  explicit BallImages(const std::vector<LampInBall>& lamps);
  /// Those of flat lamps that fill little of what a ball of smooth glass sees: the strongest
  /// kMaxImages, or none where they are not most of the light of all.
  BallImages(const std::vector<Ball>& balls, const MaterialSet& materials, const LightSet& lights);

  bool empty() const { return images_.empty(); }
  const std::vector<BallImage>& images() const { return images_; }

 private:
  std::vector<BallImage> images_;
};

}  // namespace strata
