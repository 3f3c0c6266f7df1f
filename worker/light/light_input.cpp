#include "worker/light/light_input.h"

#include <cmath>

#include "common/image_file.h"
#include "worker/math/elementary.h"

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

}  // namespace

absl::StatusOr<LightImage> ReadLightImage(const std::string& path, float scale,
                                          const FileSource& source) {
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path local, source.Locate(path));
  STRATA_ASSIGN_OR_RETURN(const ImageFile file, ReadImageFile(local));
  LightImage image = {file.width, file.height, {}};
  image.pixels.resize(static_cast<size_t>(file.width) * file.height);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    image.pixels[i] = Pixel(file, i) * scale;
    const Rgb p = image.pixels[i];
    if (!IsFinite(p) || p.r < 0 || p.g < 0 || p.b < 0)
      return absl::InvalidArgumentError(
          absl::StrCat(path, ": the light's pixel (", i % file.width, ", ", i / file.width,
                       ") is negative or not finite; light can be neither"));
  }
  return image;
}

absl::Status CheckEqualArea(const LightImage& image, const std::string& path) {
  if (image.width == image.height) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(
      path, ": the image is ", image.width, "x", image.height,
      " pixels, but the equal-area layout is square; convert it with 'imgtool makeequiarea'"));
}

absl::StatusOr<Frame> LightAxes(const Transform& to_world) {
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
        "the light's transform shears or is singular; use rotations and scales alone");
  return axes;
}

}  // namespace strata
