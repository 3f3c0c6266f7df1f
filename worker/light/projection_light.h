#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "common/status.h"
#include "worker/light/delta_lights.h"
#include "worker/light/light_sample.h"
#include "worker/math/vec.h"
#include "worker/sampling/distribution.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

namespace strata {

/// A picture before a lens: intensity over the directions that leave a point through a rectangle at
/// the distance 1 (PBRT 12.2.2). As pbrt-v4 does, the look-up takes the nearest pixel.
struct Projection {
  /// Reads the image of `light` through `source`; its scale and power are in the pixels.
  /// INVALID_ARGUMENT with its path when it holds negative or non-finite values, or when the
  /// light's transform shears.
  static absl::StatusOr<Projection> Load(const ProjectionLightDescription& light,
                                         const FileSource& source);

  /// `pixels` holds width * height intensities, row 0 first, at the top.
  Projection(int width, int height, std::vector<Rgb> pixels, const Frame& axes, float fov);

  /// Cosine of the angle between the axis and the picture's corners.
  float CosCorner() const { return 1 / std::sqrt(1 + tan_x * tan_x + tan_y * tan_y); }
  /// Solid angle per area of the unit square around a direction of this cosine to the axis.
  float Density(float cosine) const { return 4 * tan_x * tan_y * cosine * cosine * cosine; }

  /// Where in the unit square a local direction passes, (0, 0) the outer corner of the first pixel;
  /// none outside of the picture.
  std::optional<Vec2f> SquareAt(Vec3f local) const {
    if (!(local.z > 0)) return std::nullopt;
    const Vec2f st = {0.5f + 0.5f * local.x / (local.z * tan_x),
                      0.5f - 0.5f * local.y / (local.z * tan_y)};
    const bool inside = st.x >= 0 && st.x < 1 && st.y >= 0 && st.y < 1;
    return inside ? std::optional(st) : std::nullopt;
  }
  Vec3f DirectionAt(Vec2f st) const {
    return Normalize(Vec3f{(2 * st.x - 1) * tan_x, (1 - 2 * st.y) * tan_y, 1});
  }
  Rgb PixelAt(Vec2f st) const {
    const int x = std::min(static_cast<int>(st.x * width), width - 1);
    const int y = std::min(static_cast<int>(st.y * height), height - 1);
    return pixels[static_cast<size_t>(y) * width + x];
  }

  int width, height;
  Frame axes;          ///< In world space: to the picture's right, up, and the axis.
  float tan_x, tan_y;  ///< Half the width and height at the distance 1.
  std::vector<Rgb> pixels;
  PiecewiseConstant2D distribution;  ///< By luminance of the intensity and solid angle.
  Rgb power;
};

struct ProjectionLight {
  Vec3f position;
  const Projection* projection = nullptr;  ///< Owned by the LightSet.
};

/// Intensity towards `w`, world and unit, away from the light.
inline Rgb Intensity(const ProjectionLight& light, Vec3f w) {
  const Projection& projection = *light.projection;
  const std::optional<Vec2f> st = projection.SquareAt(projection.axes.ToLocal(w));
  return st ? projection.PixelAt(*st) : Rgb{};
}

inline std::optional<LightSample> SampleLi(const ProjectionLight& light, Vec3f from, Vec2f /*u*/) {
  return SampleFromPoint(light, from);
}

}  // namespace strata
