#include "worker/light/environment.h"

#include <cmath>

#include "worker/light/light_input.h"

namespace strata {

absl::StatusOr<EnvironmentImage> EnvironmentImage::Load(const ImageInfiniteLightDescription& light,
                                                        const FileSource& source,
                                                        bool compensated) {
  STRATA_ASSIGN_OR_RETURN(LightImage image, ReadLightImage(light.path, light.scale, source));
  EnvironmentMapping mapping = light.mapping;
  if (mapping == EnvironmentMapping::kByShape)
    mapping =
        image.width == image.height ? EnvironmentMapping::kEqualArea : EnvironmentMapping::kLatLong;
  if (mapping == EnvironmentMapping::kEqualArea)
    STRATA_RETURN_IF_ERROR(CheckEqualArea(image, light.path));
  STRATA_ASSIGN_OR_RETURN(const Frame axes, LightAxes(light.to_world));
  return EnvironmentImage(image.width, image.height, std::move(image.pixels), mapping, axes,
                          compensated);
}

EnvironmentImage::EnvironmentImage(int width, int height, std::vector<Rgb> radiances,
                                   EnvironmentMapping mapping, const Frame& axes, bool compensated)
    : width(width), height(height), mapping(mapping), axes(axes), pixels(std::move(radiances)) {
  // Rows of a lat-long image shrink towards the poles.
  std::vector<double> row_weights(height, 1.0);
  if (mapping == EnvironmentMapping::kLatLong) {
    for (int y = 0; y < height; ++y) row_weights[y] = Sin(std::numbers::pi * (y + 0.5) / height);
  }
  double sum[3] = {0, 0, 0}, solid_angle = 0;
  for (size_t i = 0; i < pixels.size(); ++i) {
    const double row = row_weights[i / width];
    sum[0] += row * pixels[i].r;
    sum[1] += row * pixels[i].g;
    sum[2] += row * pixels[i].b;
    solid_angle += row;
  }
  mean = {static_cast<float>(sum[0] / solid_angle), static_cast<float>(sum[1] / solid_angle),
          static_cast<float>(sum[2] / solid_angle)};
  // A little above the mean, which is known to its rounding.
  float everywhere = compensated ? Luminance(mean) * (1 + 1e-5f) : 0;
  float most = 0;
  for (const Rgb& pixel : pixels) most = std::max(most, Luminance(pixel));
  if (!(most > everywhere)) everywhere = 0;
  std::vector<float> weights(pixels.size());
  for (size_t i = 0; i < pixels.size(); ++i) {
    const double above = std::max(double{Luminance(pixels[i])} - everywhere, 0.0);
    weights[i] = static_cast<float>(row_weights[i / width] * above);
  }
  distribution = PiecewiseConstant2D(weights, width, height);
}

}  // namespace strata
