#pragma once

#include <cstdint>

#include "worker/geometry/geometry.h"
#include "worker/geometry/placement.h"
#include "worker/geometry/surfaces.h"

namespace strata {

/// A curved surface placed in the space of its group.
struct CurvedShape {
  CurvedSurface surface = BilinearPatchSurface{};
  Placement placement;   ///< Of the surface in the group's space.
  bool flipped = false;  ///< The outer side is opposite to dp/du x dp/dv of the surface.
  MaterialId material = 0;
  int32_t light = -1;
  AlphaMask alpha;
};

/// The nearest hit, in the surface's own space; `ray` is in the group's.
std::optional<SurfaceHit> Intersect(const CurvedShape& shape, const SurfaceRay& ray);

/// What is known of the surface at a hit, in the group's space.
SurfacePoint PointOn(const CurvedShape& shape, const SurfaceHit& hit);
SurfaceDerivatives DerivativesOn(const CurvedShape& shape, const SurfaceHit& hit);

/// See Geometry::SampleEmitter and EmitterPdfArea.
EmitterPoint SampleArea(const CurvedShape& shape, Vec2f u);
float PdfArea(const CurvedShape& shape, Vec3f p);
/// See Geometry::EmitterUv.
Vec2f UvAt(const CurvedShape& shape, Vec3f p);

/// Area in the group's space, to about five digits where the placement is no similarity. It costs
/// thousands of samples: for emitters.
double AreaOf(const CurvedShape& shape);
/// Whether there is any, at the cost of one: a mesh may have millions of patches.
bool HasArea(const CurvedShape& shape);

/// A box in the group's space that holds the surface.
Box BoundsOf(const CurvedShape& shape);

}  // namespace strata
