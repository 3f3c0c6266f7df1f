#pragma once

#include <optional>
#include <vector>

#include "common/status.h"
#include "worker/light/delta_lights.h"
#include "worker/light/environment_map.h"
#include "worker/light/light_sample.h"
#include "worker/math/vec.h"
#include "worker/sampling/distribution.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

namespace strata {

/// A lamp's measured intensity over all directions, as a square of pixels in the equal-area layout
/// with its third axis up (PBRT 12.2.3). Between the centres of pixels it is interpolated, across
/// the square's edges too.
struct Diagram {
  /// Reads an image, of which the mean of the channels counts, or an IES file (*.ies; see ies.h),
  /// whose candelas are taken as they are. What is not in the equal-area layout is resampled.
  /// INVALID_ARGUMENT with the path (and line) when an image of that layout is not square, holds
  /// negative or non-finite values, or is malformed.
  static absl::StatusOr<Diagram> Load(const std::string& path, EnvironmentMapping mapping,
                                      const FileSource& source);

  /// `values` holds size * size intensities, row 0 first.
  Diagram(int size, std::vector<float> values);

  /// Towards a local unit direction.
  float At(Vec3f local) const;

  int size;
  std::vector<float> values;
  float mean = 0;                    ///< Over the sphere.
  PiecewiseConstant2D distribution;  ///< Positive where the intensity is.
};

/// A point that shines as a diagram says.
struct GoniometricLight {
  Vec3f position;
  Rgb intensity;                     ///< Multiplies the diagram's.
  Frame axes;                        ///< The diagram's in world space; may be left-handed.
  const Diagram* diagram = nullptr;  ///< Owned by the LightSet.
};

/// Intensity towards `w`, world and unit, away from the light.
inline Rgb Intensity(const GoniometricLight& light, Vec3f w) {
  return light.intensity * light.diagram->At(light.axes.ToLocal(w));
}

inline std::optional<LightSample> SampleLi(const GoniometricLight& light, Vec3f from, Vec2f /*u*/) {
  return SampleFromPoint(light, from);
}

}  // namespace strata
