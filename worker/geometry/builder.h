#pragma once

#include <optional>
#include <vector>

#include "common/status.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/state.h"

namespace strata {

/// Puts described shapes into groups: places them, checks them, collects the emitters.
class ShapeBuilder {
 public:
  /// Both must outlive the builder.
  ShapeBuilder(const SceneDescription& scene, std::vector<Emitter>* emitters)
      : scene_(scene), emitters_(*emitters) {}

  /// Adds the shape to `group`, placed by `to_group` after its own transform. It emits if
  /// `may_emit`. Shapes that are no surface (interfaces, alpha 0) or have no area add nothing.
  /// INVALID_ARGUMENT with the shape's location.
  absl::Status Add(const ShapeDescription& shape, const Transform& to_group, bool may_emit,
                   ShapeGroup* group);

 private:
  absl::Status AddMesh(const ShapeDescription& shape, const TriangleMeshShape& mesh,
                       const Transform& to_group, bool may_emit, TriangleSet* set);
  absl::Status AddPatches(const ShapeDescription& shape, const BilinearPatchShape& patches,
                          const Transform& to_group, bool may_emit, ShapeGroup* group);
  absl::Status AddQuadric(const ShapeDescription& shape, CurvedSurface surface,
                          const Transform& to_group, bool may_emit, ShapeGroup* group);
  void AddCurved(const ShapeDescription& shape, CurvedShape curved, bool may_emit,
                 ShapeGroup* group);
  absl::Status CheckAlpha(const ShapeDescription& shape) const;
  /// Alpha where it is the same over the shape.
  std::optional<float> ConstantAlpha(const ShapeDescription& shape) const;
  bool IsCutAway(const ShapeDescription& shape) const;
  bool HasMask(const ShapeDescription& shape) const;
  int32_t AddEmitter(const ShapeDescription& shape, Emitter emitter);

  const SceneDescription& scene_;
  std::vector<Emitter>& emitters_;
};

}  // namespace strata
