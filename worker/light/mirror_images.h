#pragma once

#include <vector>

#include "worker/bsdf/material.h"
#include "worker/geometry/geometry.h"
#include "worker/light/light_bounds.h"
#include "worker/math/lanes.h"

namespace strata {

/// Images of the lamps in flat metal rectangles, mirrors or rough: where the light comes from that
/// paths from a wall by a reflector to a lamp find too rarely. Guides directions (MirrorGuide) and
/// changes no expectation, so that what it says need not be exact. Immutable.
class MirrorImages {
 public:
  static constexpr size_t kMaxImages = 32;

  /// Eight images side by side; where there are fewer, the rest has strength 0.
  struct Images {
    Vec3Lanes corner, unit1, unit2;  ///< The reflector; unit vectors along its edges.
    FloatLanes length1 = {}, length2 = {};
    Vec3Lanes normal;          ///< Unit, to the side of the lamp.
    Vec3Lanes center;          ///< Of the lamp's image, behind the reflector.
    FloatLanes height = {};    ///< Of the lamp over the reflector's plane.
    FloatLanes radius = {};    ///< Of the lamp.
    FloatLanes alpha = {};     ///< Of the reflector; 0: a mirror.
    FloatLanes strength = {};  ///< Luminance of the intensity, times the reflectance. Relative.
  };
  /// Eight lamps side by side, the rest with intensity 0.
  struct Lamps {
    Vec3Lanes center;
    FloatLanes intensity = {};
  };

  MirrorImages() = default;
  /// Looks at pairs of triangles in the world (not in instances) that make a rectangle of one metal
  /// that is the same everywhere, and keeps the images of `lamps` that may matter and are not
  /// wholly hidden. None at all where the strongest kMaxImages are not most of the light.
  MirrorImages(const Geometry& geometry, const MaterialSet& materials,
               const std::vector<LightBounds>& lamps);

  bool empty() const { return images_.empty(); }
  const std::vector<Images>& images() const { return images_; }
  const std::vector<Lamps>& lamps() const { return lamps_; }

 private:
  std::vector<Images> images_;
  std::vector<Lamps> lamps_;
};

}  // namespace strata
