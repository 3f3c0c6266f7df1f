#include "worker/light/projection_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "worker/light/light_input.h"
#include "worker/math/elementary.h"

namespace strata {
namespace {

/// Of half the field of view, which spans the picture's shorter side.
float HalfTangent(float fov) {
  const SinCosResult<double> half = SinCos(fov * (std::numbers::pi / 360));
  return static_cast<float>(half.sin / half.cos);
}

}  // namespace

absl::StatusOr<Projection> Projection::Load(const ProjectionLightDescription& light,
                                            const FileSource& source) {
  STRATA_ASSIGN_OR_RETURN(LightImage image, ReadLightImage(light.path, light.scale, source));
  STRATA_ASSIGN_OR_RETURN(const Frame axes, LightAxes(light.to_world));
  Projection projection(image.width, image.height, std::move(image.pixels), axes, light.fov);
  if (!light.power) return projection;
  const double scale = *light.power / Luminance(projection.power);
  if (!std::isfinite(static_cast<float>(scale)))
    return absl::InvalidArgumentError(absl::StrCat(
        light.path, ": the image is black or too dark to be given a \"power\"; leave that out"));
  for (Rgb& pixel : projection.pixels) pixel *= static_cast<float>(scale);
  projection.power *= static_cast<float>(scale);
  return projection;
}

Projection::Projection(int width, int height, std::vector<Rgb> intensities, const Frame& axes,
                       float fov)
    : width(width), height(height), axes(axes), pixels(std::move(intensities)) {
  const float shorter = static_cast<float>(std::min(width, height));
  tan_x = HalfTangent(fov) * static_cast<float>(width) / shorter;
  tan_y = HalfTangent(fov) * static_cast<float>(height) / shorter;
  // Solid angles of pixels, from those of the rectangles between the axis and their corners.
  const auto corner = [&](int x, int y) {
    const double a = tan_x * (2.0 * x / width - 1), b = tan_y * (2.0 * y / height - 1);
    return Atan2(a * b, std::sqrt(1 + a * a + b * b));
  };
  std::vector<double> above(static_cast<size_t>(width) + 1), below(above.size());
  for (int x = 0; x <= width; ++x) below[x] = corner(x, 0);
  std::vector<float> weights;
  weights.reserve(pixels.size());
  double sum[3] = {0, 0, 0};
  for (int y = 0; y < height; ++y) {
    std::swap(above, below);
    for (int x = 0; x <= width; ++x) below[x] = corner(x, y + 1);
    for (int x = 0; x < width; ++x) {
      const Rgb pixel = pixels[weights.size()];
      const double solid_angle = below[x + 1] - below[x] - above[x + 1] + above[x];
      weights.push_back(static_cast<float>(solid_angle) * Luminance(pixel));
      sum[0] += solid_angle * pixel.r;
      sum[1] += solid_angle * pixel.g;
      sum[2] += solid_angle * pixel.b;
    }
  }
  power = {static_cast<float>(sum[0]), static_cast<float>(sum[1]), static_cast<float>(sum[2])};
  distribution = PiecewiseConstant2D(weights, width, height);
}

}  // namespace strata
