#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/status.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/surfaces.h"

namespace strata {

/// The curves of one kind of many shapes in one space, as arrays that Embree shares: cubic Bezier
/// segments (PBRT 6.7).
///
/// Flat ones face each ray, and Embree takes no hit of one nearer than its width, so that a ray
/// that leaves does not meet it again. Cylinders are tubes without ends, swept by a circle. Ribbons
/// lie across their normals.
struct CurveSet {
  /// A control point.
  struct Vertex {
    Vec3f p;
    float radius = 0;  ///< Half the width.
  };
  static_assert(sizeof(Vertex) == 16);
  struct Segment {
    uint32_t first_vertex = 0;  ///< Of four.
    MaterialId material = 0;
    uint32_t flipped = 0;  ///< The outer side of a cylinder is its inside, of a ribbon its back.
    int32_t mask = -1;     ///< Into CurveSet::masks; -1: all of it is there.
  };

  std::vector<Vertex> vertices;
  std::vector<Vec3f> normals;  ///< Of ribbons: for each vertex.
  std::vector<Segment> segments;
  std::vector<AlphaMask> masks;
};

/// One for each CurveKind.
using CurveSets = std::array<CurveSet, 3>;

/// Pieces that Embree parts a flat segment into.
inline constexpr int kFlatCurvePieces = 16;

/// Adds the shape's curves, placed in the space of `sets` by `placed`. Under a transform that is no
/// similarity their radii scale by its mean factor. INVALID_ARGUMENT with the shape's location.
/// `masked` says whether the shape's alpha leaves some of it out.
absl::Status AddCurves(const ShapeDescription& shape, const CurveShape& curves,
                       const Transform& placed, bool masked, CurveSets* sets);

/// What is known of a curve where `ray` met it; both in the set's space.
SurfacePoint PointOnCurve(const CurveSets& sets, CurveKind kind, const Hit& hit,
                          const SurfaceRay& ray);

/// A box that holds the curves.
Box BoundsOf(const CurveSets& sets);

}  // namespace strata
