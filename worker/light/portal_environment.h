#pragma once

#include <array>
#include <optional>

#include "common/status.h"
#include "worker/light/environment.h"
#include "worker/light/light_sample.h"
#include "worker/sampling/windowed_distribution.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

namespace strata {

/// A picture of the surroundings that is seen through a rectangle alone: a window of a room (PBRT
/// 12.5.3; Bitterli et al. 2015, "Portal-Masked Environment Map Sampling"). Directions are told by
/// the angles of their projections on the two planes across the portal, in which it is a rectangle
/// from everywhere, so that a table of sums gives the density of what is seen through it.
struct PortalImage {
  /// As EnvironmentImage::Load, and INVALID_ARGUMENT for a portal that is no rectangle.
  static absl::StatusOr<PortalImage> Load(const ImageInfiniteLightDescription& light,
                                          const FileSource& source);

  /// A direction's place in the unit square; none for those that do not go out by the portal.
  std::optional<Vec2f> SquareAt(Vec3f local) const {
    if (!(local.z > 0)) return std::nullopt;
    return Vec2f{0.5f + kInvPi * Atan2(local.x, local.z), 0.5f + kInvPi * Atan2(local.y, local.z)};
  }
  Vec3f DirectionAt(Vec2f st) const;
  /// Solid angle per area of the square around a local direction, which is unit: by 1 - x^2 =
  /// y^2 + z^2, which does not cancel along the square's edges.
  static float Density(Vec3f local) {
    const float z2 = local.z * local.z;
    return kPi * kPi * (local.y * local.y + z2) * (local.x * local.x + z2) / local.z;
  }
  /// Per solid angle around a local direction, of a density per area of the square; 0 so near to
  /// its edges that Density underflows.
  static float PerSolidAngle(float pdf, Vec3f local) {
    const float density = Density(local);
    return density > 0 ? pdf / density : 0;
  }
  /// The part of the square that is seen through the portal from a point before it; none behind.
  std::optional<Window> WindowFrom(Vec3f from) const;
  float Area() const { return width * height; }

  EnvironmentImage sky;
  Vec3f corner;                       ///< World.
  Frame axes;                         ///< Along the portal's edges, and outwards.
  float width, height;                ///< Along x and y.
  WindowedDistribution distribution;  ///< By luminance and solid angle; positive everywhere.
  Rgb irradiance;                     ///< On the portal, from outside; about.
};

struct PortalEnvironment {
  const PortalImage* portal = nullptr;  ///< Owned by the LightSet.
};

/// From `from` in a direction that meets nothing.
inline Rgb Le(const PortalEnvironment& light, Vec3f from, Vec3f direction) {
  const PortalImage& portal = *light.portal;
  const std::optional<Vec2f> st = portal.SquareAt(portal.axes.ToLocal(direction));
  if (!st) return {};
  const std::optional<Window> window = portal.WindowFrom(from);
  if (!window || !window->Contains(*st)) return {};
  return Le(ImageEnvironment{&portal.sky}, direction);
}

inline float PdfLi(const PortalEnvironment& light, Vec3f from, Vec3f direction) {
  const PortalImage& portal = *light.portal;
  const Vec3f local = portal.axes.ToLocal(direction);
  const std::optional<Vec2f> st = portal.SquareAt(local);
  if (!st) return 0;
  const std::optional<Window> window = portal.WindowFrom(from);
  return window ? PortalImage::PerSolidAngle(portal.distribution.Pdf(*window, *st), local) : 0;
}

inline std::optional<LightSample> SampleLi(const PortalEnvironment& light, Vec3f from, Vec2f u) {
  const PortalImage& portal = *light.portal;
  const std::optional<Window> window = portal.WindowFrom(from);
  if (!window) return std::nullopt;
  float pdf = 0;
  const Vec3f local = portal.DirectionAt(portal.distribution.Sample(*window, u, &pdf));
  if (!(local.z > 0)) return std::nullopt;
  LightSample sample;
  sample.pdf = PortalImage::PerSolidAngle(pdf, local);
  if (!(sample.pdf > 0)) return std::nullopt;
  sample.wi = portal.axes.ToWorld(local);
  sample.radiance = Le(ImageEnvironment{&portal.sky}, sample.wi);
  sample.infinite = true;
  return sample;
}

}  // namespace strata
