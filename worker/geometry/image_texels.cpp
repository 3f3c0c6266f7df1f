#include "worker/geometry/image_texels.h"

#include <cmath>

#include "worker/math/elementary.h"

namespace strata {
namespace {

/// Of an image's channels, those that are colour.
int ColorChannels(const ImageFile& file) { return file.channels < 3 ? 1 : 3; }

/// `count` channels from the first on, 8-bit codes as they are, others by `decode`.
template <typename Decode>
ImageTexels Channels(const ImageFile& file, int first, int count, Decode decode) {
  ImageTexels texels;
  texels.width = file.width;
  texels.height = file.height;
  texels.channels = count;
  const size_t pixels = static_cast<size_t>(file.width) * file.height;
  const size_t values = pixels * texels.channels;
  if (file.eight_bit) {
    texels.codes.resize(values);
  } else {
    texels.values.resize(values);
  }
  for (size_t i = 0; i < values; ++i) {
    const size_t pixel = i / texels.channels;
    const float value = file.values[pixel * file.channels + first + i % texels.channels];
    if (file.eight_bit) {
      texels.codes[i] = static_cast<uint8_t>(value * 255 + 0.5f);
    } else {
      texels.values[i] = decode(value);
    }
  }
  return texels;
}

}  // namespace

absl::StatusOr<ImageFile> ReadTextureImage(const ImageTexture& texture, const FileSource& source) {
  if (texture.embedded) {
    if (const auto* pixels = std::get_if<ImageFile>(&*texture.embedded)) return *pixels;
    return ReadImageBytes(texture.path, std::get<std::string>(*texture.embedded));
  }
  STRATA_ASSIGN_OR_RETURN(const std::filesystem::path path, source.Locate(texture.path));
  return ReadImageFile(path);
}

bool HasAlpha(const ImageFile& file) { return file.channels == 2 || file.channels == 4; }

bool IsTranslucent(const ImageFile& file) {
  if (!HasAlpha(file)) return false;
  const size_t channels = static_cast<size_t>(file.channels);
  for (size_t i = channels - 1; i < file.values.size(); i += channels)
    if (file.values[i] != 1) return true;
  return false;
}

absl::Status CheckTexels(const ImageFile& file, bool alpha) {
  if (file.eight_bit || file.sixteen_bit || (alpha && !HasAlpha(file))) return absl::OkStatus();
  const int first = alpha ? file.channels - 1 : 0;
  const int end = alpha ? file.channels : ColorChannels(file);
  const size_t pixels = static_cast<size_t>(file.width) * file.height;
  for (size_t pixel = 0; pixel < pixels; ++pixel) {
    for (int channel = first; channel < end; ++channel) {
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
  return Channels(file, 0, ColorChannels(file), [&](float value) {
    return file.sixteen_bit ? static_cast<float>(Decode(value, encoding, gamma)) : value;
  });
}

ImageTexels ImageTexels::AlphaFrom(const ImageFile& file) {
  if (HasAlpha(file))
    return Channels(file, file.channels - 1, 1, [](float value) { return value; });
  ImageTexels opaque;
  opaque.width = opaque.height = opaque.channels = 1;
  opaque.values = {1};
  return opaque;
}

}  // namespace strata
