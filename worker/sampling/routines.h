#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "common/job.h"
#include "worker/sampling/disk.h"
#include "worker/sampling/hash.h"
#include "worker/sampling/rejection.h"
#include "worker/sampling/triangle_sqrt.h"
#include "worker/sampling/warp.h"
#include "worker/sampling/warp_inverse.h"

// Where a job chooses its SamplingRoutines: points of the lens, points of triangular lamps, and
// directions of the strategies `cosine` and `uniform`. The densities are those of warp.h whatever
// is chosen.

namespace strata {

/// Independent uniform floats in [0, 1) for the rejection method, which needs any number of them
/// where a path has two: a stream of hashes that starts from these.
class RejectionNumbers {
 public:
  explicit RejectionNumbers(Vec2f u)
      : hash_(HashCombine(std::bit_cast<uint32_t>(u.x), std::bit_cast<uint32_t>(u.y))) {}
  float operator()() { return static_cast<float>(HashCombine(hash_, count_++) >> 40) * 0x1p-24f; }

 private:
  uint64_t hash_, count_ = 0;
};

/// Point of the unit disk, uniform by area.
inline Vec2f SampleDiskBy(SamplingRoutines routines, Vec2f u) {
  switch (routines) {
    case SamplingRoutines::kPlain:
      return SamplePolarDisk(u);
    case SamplingRoutines::kRejection:
      return SampleDiskByRejection(RejectionNumbers(u)).point;
    case SamplingRoutines::kPreserving:
      break;
  }
  return SampleConcentricDisk(u);
}

/// Direction of the upper hemisphere, by projected solid angle: a point of the disk, lifted.
inline Vec3f SampleCosineHemisphereBy(SamplingRoutines routines, Vec2f u) {
  return LiftFromDisk(SampleDiskBy(routines, u));
}

/// Direction of the upper hemisphere, by solid angle. By inversion there is one way only.
inline Vec3f SampleUniformHemisphereBy(SamplingRoutines routines, Vec2f u) {
  if (routines != SamplingRoutines::kRejection) return SampleUniformHemisphere(u);
  Vec3f w = SampleSphereByRejection(RejectionNumbers(u)).point;
  w.z = std::fabs(w.z);
  return w;
}

/// What SampleTriangle must be given, in place of the uniform `u`, to return the point that the
/// routine would; uniform as well.
inline Vec2f TriangleNumbers(SamplingRoutines routines, Vec2f u) {
  switch (routines) {
    case SamplingRoutines::kPlain:
      return InvertTriangle(SampleTriangleSqrt(u));
    case SamplingRoutines::kRejection: {
      RejectionNumbers next(u);
      return InvertTriangle(SampleByRejection(
                                [&] {
                                  const float x = next();
                                  return Vec2f{x, next()};
                                },
                                [](Vec2f b) { return b.x + b.y <= 1; })
                                .point);
    }
    case SamplingRoutines::kPreserving:
      break;
  }
  return u;
}

}  // namespace strata
