#pragma once

#include <string>

#include <gtest/gtest.h>

#include "worker/geometry/geometry_lanes.h"

// The ways to cast a ray, for typed tests of what must hold of each.

namespace strata::testing {

/// As the reference kernel does.
struct OneByOne {
  static constexpr const char* kName = "OneByOne";
  static bool Intersect(const Geometry& geometry, const Ray& ray, Hit* hit) {
    return geometry.Intersect(ray, hit);
  }
  static bool Occluded(const Geometry& geometry, const Ray& ray) { return geometry.Occluded(ray); }
};

/// As the fast kernel does: the ray in one lane, others of the opposite direction beside it.
struct InPackets {
  static constexpr const char* kName = "InPackets";
  static constexpr int kLane = 3;

  static RayLanes PacketOf(const Ray& ray) {
    RayLanes rays;
    for (int lane = 0; lane < kLanes; ++lane) {
      rays.origin.Set(lane, ray.origin);
      rays.direction.Set(lane, lane == kLane ? ray.direction : -ray.direction);
      rays.t_max[lane] = ray.t_max;
    }
    return rays;
  }
  static bool Intersect(const Geometry& geometry, const Ray& ray, Hit* hit) {
    HitLanes hits;
    const bool met = strata::Intersect(geometry, PacketOf(ray), SameInt(-1), &hits)[kLane] != 0;
    *hit = hits.Get(kLane);
    return met;
  }
  static bool Occluded(const Geometry& geometry, const Ray& ray) {
    return strata::Occluded(geometry, PacketOf(ray), SameInt(-1))[kLane] != 0;
  }
};

using Casters = ::testing::Types<OneByOne, InPackets>;
struct CasterNames {
  template <typename Caster>
  static std::string GetName(int) {
    return Caster::kName;
  }
};

}  // namespace strata::testing
