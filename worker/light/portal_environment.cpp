#include "worker/light/portal_environment.h"

#include <algorithm>
#include <cmath>

#include "worker/math/vec3d.h"

namespace strata {
namespace {

/// Cells along each edge of the square.
constexpr int kMinSize = 64, kMaxSize = 1024;
/// Looked at in each cell, so that pixels as small as cells are found.
constexpr int kPointsPerCell = 3;
/// Of the mean: what the grid does not find keeps a chance.
constexpr double kLeast = 0.01;

}  // namespace

absl::StatusOr<PortalImage> PortalImage::Load(const ImageInfiniteLightDescription& light,
                                              const FileSource& source) {
  STRATA_ASSIGN_OR_RETURN(EnvironmentImage sky, EnvironmentImage::Load(light, source, false));
  const std::array<Vec3d, 4>& p = *light.portal;
  const Vec3d x = p[3] - p[0], y = p[1] - p[0], off = p[2] - (p[3] + y);
  const double width = Length(x), height = Length(y), size = width + height;
  constexpr double kTolerance = 1e-3;
  if (!(width > 0 && height > 0 && std::isfinite(size) && Length(off) <= kTolerance * size &&
        std::abs(Dot(x, y)) <= kTolerance * width * height))
    return absl::InvalidArgumentError(
        "the corners of the light's \"portal\" are not those of a rectangle, in order");
  // Exactly orthogonal, whatever the corners' rounding.
  const Vec3d unit_x = x * (1 / width), z = Normalize(Cross(x, y)), unit_y = Cross(z, unit_x);
  PortalImage portal = {.sky = std::move(sky),
                        .corner = ToFloat(p[0]),
                        .axes = {ToFloat(unit_x), ToFloat(unit_y), ToFloat(z)},
                        .width = static_cast<float>(width),
                        .height = static_cast<float>(height)};

  const int cells = std::clamp(std::max(portal.sky.width, portal.sky.height), kMinSize, kMaxSize);
  const int points = cells * kPointsPerCell;
  const double area = 1 / (static_cast<double>(points) * points);
  std::vector<float> weights(static_cast<size_t>(cells) * cells, 0.0f);
  double sum[3] = {0, 0, 0}, total = 0;
  for (int row = 0; row < points; ++row) {
    for (int column = 0; column < points; ++column) {
      const Vec3f local =
          portal.DirectionAt({(static_cast<float>(column) + 0.5f) / static_cast<float>(points),
                              (static_cast<float>(row) + 0.5f) / static_cast<float>(points)});
      const Rgb radiance = Le(ImageEnvironment{&portal.sky}, portal.axes.ToWorld(local));
      const float density = Density(local);
      const float weight = Luminance(radiance) * density;
      weights[static_cast<size_t>(row / kPointsPerCell) * cells + column / kPointsPerCell] +=
          weight;
      total += weight;
      sum[0] += area * density * local.z * radiance.r;
      sum[1] += area * density * local.z * radiance.g;
      sum[2] += area * density * local.z * radiance.b;
    }
  }
  const float least = static_cast<float>(kLeast * total / static_cast<double>(weights.size()));
  for (float& weight : weights) weight += least;
  portal.distribution = WindowedDistribution(weights, cells, cells);
  portal.irradiance = {static_cast<float>(sum[0]), static_cast<float>(sum[1]),
                       static_cast<float>(sum[2])};
  return portal;
}

Vec3f PortalImage::DirectionAt(Vec2f st) const {
  const auto [sin_x, cos_x] = SinCos2Pi(0.5f * (st.x - 0.5f));
  const auto [sin_y, cos_y] = SinCos2Pi(0.5f * (st.y - 0.5f));
  // (tan x, tan y, 1), all times both cosines, so that nothing is infinite.
  return Normalize(Vec3f{sin_x * cos_y, sin_y * cos_x, cos_x * cos_y});
}

std::optional<Window> PortalImage::WindowFrom(Vec3f from) const {
  const Vec3f low = axes.ToLocal(corner - from);
  if (!(low.z > 0)) return std::nullopt;
  return Window{*SquareAt(low), *SquareAt({low.x + width, low.y + height, low.z})};
}

}  // namespace strata
