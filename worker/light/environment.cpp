#include "worker/light/environment.h"

#include <cmath>

#include "common/image_file.h"

namespace strata {
namespace {

/// sRGB's transfer curve (IEC 61966-2-1), for images of 8 bits.
float Linearize(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : Pow((encoded + 0.055f) / 1.055f, 2.4f);
}

Rgb Pixel(const ImageFile& image, size_t index) {
  const float* value = &image.values[index * image.channels];
  const Rgb color = image.channels < 3 ? Rgb::Gray(value[0]) : Rgb{value[0], value[1], value[2]};
  if (!image.eight_bit) return color;
  return {Linearize(color.r), Linearize(color.g), Linearize(color.b)};
}

absl::StatusOr<Frame> Axes(const Transform& to_world) {
  const auto axis = [&](Vec3d v) {
    const Vec3d w = to_world.Vector(v);
    const double length = std::sqrt(w.x * w.x + w.y * w.y + w.z * w.z);
    return Vec3f{static_cast<float>(w.x / length), static_cast<float>(w.y / length),
                 static_cast<float>(w.z / length)};
  };
  const Frame axes = {axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})};
  constexpr float kTolerance = 1e-4f;
  if (!(AbsDot(axes.x, axes.y) < kTolerance && AbsDot(axes.y, axes.z) < kTolerance &&
        AbsDot(axes.z, axes.x) < kTolerance))
    return absl::InvalidArgumentError(
        "the environment's transform shears or is singular; use rotations and scales alone");
  return axes;
}

}  // namespace

absl::StatusOr<EnvironmentImage> EnvironmentImage::Load(const ImageInfiniteLightDescription& light,
                                                        const FileSource& source,
                                                        bool compensated) {
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path path, source.Locate(light.path));
  STRATA_ASSIGN_OR_RETURN(const ImageFile file, ReadImageFile(path));
  EnvironmentMapping mapping = light.mapping;
  if (mapping == EnvironmentMapping::kByShape)
    mapping =
        file.width == file.height ? EnvironmentMapping::kEqualArea : EnvironmentMapping::kLatLong;
  if (mapping == EnvironmentMapping::kEqualArea && file.width != file.height)
    return absl::InvalidArgumentError(absl::StrCat(
        light.path, ": the environment is ", file.width, "x", file.height,
        " pixels, but the equal-area layout is square; convert it with 'imgtool makeequiarea'"));
  STRATA_ASSIGN_OR_RETURN(const Frame axes, Axes(light.to_world));
  std::vector<Rgb> pixels(static_cast<size_t>(file.width) * file.height);
  for (size_t i = 0; i < pixels.size(); ++i) {
    pixels[i] = Pixel(file, i) * light.scale;
    const Rgb p = pixels[i];
    if (!IsFinite(p) || p.r < 0 || p.g < 0 || p.b < 0)
      return absl::InvalidArgumentError(
          absl::StrCat(light.path, ": the environment's pixel (", i % file.width, ", ",
                       i / file.width, ") is negative or not finite; radiance can be neither"));
  }
  return EnvironmentImage(file.width, file.height, std::move(pixels), mapping, axes, compensated);
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
