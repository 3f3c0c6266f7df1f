#pragma once

#include <memory>
#include <optional>
#include <string>

#include "worker/light/light_set.h"

namespace strata {

/// One emissive shape in an empty scene, as the integrator sees it: chosen points on one side, what
/// rays meet on the other.
class Lamp {
 public:
  explicit Lamp(ShapeDescription shape);
  /// Its radiance is multiplied by `texture`, whose images are in `source`.
  Lamp(ShapeDescription shape, const TextureDescription& texture,
       const FileSource& source = DirectorySource("."));

  /// Of the light set, whose only light it is.
  std::optional<LightSample> Sample(Vec3f from, Vec2f u) const {
    return lights_.Sample(0, from, u);
  }

  /// Whether anything, so the lamp itself, hides what was chosen.
  bool IsHidden(Vec3f from, const LightSample& sample) const {
    return geometry_->Occluded({from, sample.end - from, 1 - 0x1p-14f});
  }

  /// Where a ray meets a side that emits.
  struct Meeting {
    EmissionHit hit;
    Rgb radiance;
    float pdf;  ///< Of having sampled this point, per solid angle at `from`.
  };
  /// All of them in order. Samples do not know what hides them, so the far ones count as well; but
  /// of a sphere sampled by its cone, from outside, only the nearest can be chosen.
  std::vector<Meeting> Meetings(Vec3f from, Vec3f direction) const;
  /// The density with which Sample finds a direction.
  float Pdf(Vec3f from, Vec3f direction) const;

  bool IsSphere() const;

 private:
  void Build(SceneDescription scene, const FileSource& source);

  std::unique_ptr<Geometry> geometry_;
  std::unique_ptr<TextureSet> textures_;
  LightSet lights_;
};

/// A point that looks at a lamp.
struct LampCase {
  std::string name;
  ShapeDescription shape;
  Vec3f from;
};

/// `two_sided` shapes of radiance 1 (but for their colour).
ShapeDescription EmissiveShape(ShapeGeometry geometry, const Transform& to_world = {},
                               bool two_sided = true);

/// Every kind of lamp from near, far, within and edge-on. Of curved lamps that are sampled by area
/// no limb is in view: the density is infinite there, though its integral is not.
std::vector<LampCase> AllLampCases();

}  // namespace strata
