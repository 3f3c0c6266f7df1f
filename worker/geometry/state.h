#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "worker/geometry/curve_set.h"
#include "worker/geometry/curved_shape.h"
#include "worker/geometry/embree_compat.h"
#include "worker/geometry/few_triangles.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/placement.h"
#include "worker/geometry/triangle_set.h"

namespace strata {

// Embree ids of the geometries in a group's scene.
inline constexpr uint32_t kTriangleGeometry = 0;
inline constexpr uint32_t kCurvedGeometry = 1;
inline constexpr uint32_t kMaskedGeometry = 2;
inline constexpr uint32_t kFirstCurveGeometry = 3;  ///< Of the first CurveKind; others follow.
inline constexpr uint32_t kFirstInstance = 6;       ///< Only in the world's scene.

/// Shapes that share a space and an Embree scene: the world's own, or those of an object.
struct ShapeGroup {
  TriangleSet triangles;
  /// The triangles of shapes with an alpha mask, apart from the others so that only these ask for
  /// theirs.
  TriangleSet masked;
  std::vector<AlphaMask> masks;  ///< Of the shapes of `masked`.
  std::vector<CurvedShape> curved;
  CurveSets curves;
  RTCScene scene = nullptr;
  const Geometry::State* state = nullptr;  ///< That it belongs to.

  bool IsEmpty() const { return triangles.triangles.empty() && HasPlainTrianglesOnly(); }
  /// Nothing but `triangles`, if that.
  bool HasPlainTrianglesOnly() const {
    return masked.triangles.empty() && curved.empty() &&
           std::all_of(curves.begin(), curves.end(),
                       [](const CurveSet& set) { return set.segments.empty(); });
  }
};

/// An object placed in the world by Embree's instancing.
struct Instance {
  const ShapeGroup* object = nullptr;
  Placement placement;
  /// What the world-to-object transform of a ray's origin in float may err by, as a distance in the
  /// world: this matrix times |p| + |translation|.
  double origin_error[3][3] = {};
  int32_t motion = -1;  ///< Index into State::motions; -1: it does not move.
};

/// The maps of a moving instance at equal steps of time, as Embree holds them: their elements are
/// floats. See MotionSteps.
struct InstanceMotion {
  std::vector<Placement::Rows> steps;
};

struct Geometry::State {
  RTCDevice device = nullptr;
  ShapeGroup world;
  FewTriangles few;  ///< The world's, if that is all there is.
  std::vector<std::unique_ptr<ShapeGroup>> objects;
  std::vector<Instance> instances;
  const TextureSet* textures = nullptr;  ///< Of alpha masks; without them all is there.
  std::vector<InstanceMotion> motions;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State();
};

/// Creates the Embree scene of a group whose shapes are final, uncommitted. The group must stay
/// where it is.
void CreateEmbreeScene(RTCDevice device, ShapeGroup* group);

/// Places `instance.object` in the world's scene under Embree id kFirstInstance + `index`. `motion`
/// is null if it does not move.
void AttachInstance(RTCDevice device, RTCScene world, const Instance& instance,
                    const InstanceMotion* motion, uint32_t index);

}  // namespace strata
