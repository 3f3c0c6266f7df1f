#include "worker/geometry/image_texels.h"

#include <cmath>

#include "worker/math/elementary.h"

namespace strata {
namespace {

/// Of an image's channels, those that are colour.
int ColorChannels(const ImageFile& file) { return file.channels < 3 ? 1 : 3; }

}  // namespace

absl::StatusOr<ImageFile> ReadTextureImage(const ImageTexture& texture, const FileSource& source) {
  if (texture.embedded) {
    if (const auto* pixels = std::get_if<ImageFile>(&*texture.embedded)) return *pixels;
    return ReadImageBytes(texture.path, std::get<std::string>(*texture.embedded));
  }
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path path, source.Locate(texture.path));
  return ReadImageFile(path);
}

absl::Status CheckTexels(const ImageFile& file) {
  if (file.eight_bit || file.sixteen_bit) return absl::OkStatus();
  const size_t pixels = static_cast<size_t>(file.width) * file.height;
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    for (int channel = 0; channel < ColorChannels(file); ++channel) {
      if (std::isfinite(file.values[pixel * file.channels + channel])) continue;
      return absl::InvalidArgumentError(absl::StrCat("the image's texel (", pixel % file.width,
                                                     ", ", pixel / file.width,
                                                     ") is NaN or infinite"));
    }
  }
  return absl::OkStatus();
}

double Decode(double value, ImageEncoding encoding, float gamma) {
  switch (encoding) {
    case ImageEncoding::kLinear:
      return value;
    case ImageEncoding::kGamma:
      return Pow(value, static_cast<double>(gamma));
    case ImageEncoding::kSrgb:
      return value <= 0.04045 ? value / 12.92 : Pow((value + 0.055) / 1.055, 2.4);
  }
  return value;
}

DecodeTable MakeDecodeTable(ImageEncoding encoding, float gamma) {
  DecodeTable table;
  for (int code = 0; code < 256; ++code)
    table[code] = static_cast<float>(Decode(code / 255.0, encoding, gamma));
  return table;
}

ImageTexels ImageTexels::From(const ImageFile& file, ImageEncoding encoding, float gamma) {
  ImageTexels texels;
  texels.width = file.width;
  texels.height = file.height;
  texels.channels = ColorChannels(file);
  const size_t pixels = static_cast<size_t>(file.width) * file.height;
  const size_t count = pixels * texels.channels;
  if (file.eight_bit) {
    texels.codes.resize(count);
  } else {
    texels.values.resize(count);
  }
  for (size_t i = 0; i < count; ++i) {
    const size_t pixel = i / texels.channels;
    const float value = file.values[pixel * file.channels + i % texels.channels];
    if (file.eight_bit) {
      texels.codes[i] = static_cast<uint8_t>(value * 255 + 0.5f);
    } else if (file.sixteen_bit) {
      texels.values[i] = static_cast<float>(Decode(value, encoding, gamma));
    } else {
      texels.values[i] = value;
    }
  }
  return texels;
}

}  // namespace strata
