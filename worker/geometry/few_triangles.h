#pragma once

#include <vector>

#include "worker/geometry/geometry_lanes.h"
#include "worker/geometry/triangle_set.h"

namespace strata {

/// The triangles of a small scene, each tested against eight rays at a time. Up to kMost of them
/// that costs less than walking a hierarchy, whose nodes hold everything anyway. The test is
/// Moeller and Trumbore's with a precomputed normal ("Fast, minimum storage ray/triangle
/// intersection", 1997), as Embree has it, so that the error bounds of PointOnTriangle hold.
class FewTriangles {
 public:
  /// In a room of boxes both are equally fast at about 140 triangles (docs/performance.md).
  static constexpr size_t kMost = 96;

  FewTriangles() = default;
  /// Holds nothing if there are more than kMost.
  explicit FewTriangles(const TriangleSet& set);

  bool empty() const { return triangles_.empty(); }
  /// Of the free functions of the same names, for a world of these triangles alone.
  MaskLanes Intersect(const RayLanes& rays, MaskLanes active, HitLanes* hits) const;
  MaskLanes Occluded(const RayLanes& rays, MaskLanes active) const;

 private:
  /// A triangle p0 + u e1 + v e2; `e2`, `minus_e1` and `normal` = e1 x e2 are scaled by a power of
  /// two that gives the normal a length in [1, 2), so that no product of theirs leaves the range of
  /// float.
  struct Triangle {
    Vec3f p0, e2, minus_e1, normal;
    int32_t primitive = 0;
  };
  struct Test;

  std::vector<Triangle> triangles_;
};

}  // namespace strata
