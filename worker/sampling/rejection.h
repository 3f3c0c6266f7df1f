#pragma once

#include "worker/math/vec.h"

// The rejection method (PBRT A.3): candidates are drawn until one is accepted. How many numbers
// that takes is random, so it does not go with the padded dimensions of a path: `next` gives
// independent uniform floats in [0, 1).

namespace strata {

template <typename Point>
struct RejectionSample {
  Point point;
  int tries = 1;  ///< Candidates drawn, this one included: geometric, of mean 1 / acceptance.
};

/// The first of `propose`'s candidates that `accept` takes. Its density is that of the candidates
/// times the probability with which it is taken, over the acceptance.
template <typename Propose, typename Accept>
auto SampleByRejection(Propose&& propose, Accept&& accept) {
  RejectionSample<decltype(propose())> sample{propose()};
  while (!accept(sample.point)) {
    sample.point = propose();
    ++sample.tries;
  }
  return sample;
}

/// A point of the unit disk, uniform by area. Acceptance pi / 4.
template <typename Next>
RejectionSample<Vec2f> SampleDiskByRejection(Next&& next) {
  return SampleByRejection(
      [&] {
        const float x = 2 * next() - 1;
        return Vec2f{x, 2 * next() - 1};
      },
      [](Vec2f p) { return p.x * p.x + p.y * p.y <= 1; });
}

namespace rejection_detail {
template <typename Next>
Vec3f PointOfCube(Next& next) {
  const float x = 2 * next() - 1, y = 2 * next() - 1;
  return {x, y, 2 * next() - 1};
}
}  // namespace rejection_detail

/// A point of the unit ball, uniform by volume. Acceptance pi / 6.
template <typename Next>
RejectionSample<Vec3f> SampleBallByRejection(Next&& next) {
  return SampleByRejection([&] { return rejection_detail::PointOfCube(next); },
                           [](Vec3f p) { return LengthSquared(p) <= 1; });
}

/// A direction, uniform by solid angle: that of a point of the ball, but for its innermost
/// thousandth, where the numbers' grid shows. Acceptance pi / 6, less 5e-10.
template <typename Next>
RejectionSample<Vec3f> SampleSphereByRejection(Next&& next) {
  RejectionSample<Vec3f> sample =
      SampleByRejection([&] { return rejection_detail::PointOfCube(next); },
                        [](Vec3f p) {
                          const float r2 = LengthSquared(p);
                          return r2 <= 1 && r2 >= 1e-6f;
                        });
  sample.point = Normalize(sample.point);
  return sample;
}

}  // namespace strata
