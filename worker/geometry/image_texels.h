#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "common/image_file.h"
#include "common/status.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

namespace strata {

/// The image of a texture, from its file or from where it is embedded. Errors are of the file
/// alone.
absl::StatusOr<ImageFile> ReadTextureImage(const ImageTexture& texture, const FileSource& source);

/// INVALID_ARGUMENT naming the first texel that is NaN or infinite; only floating-point images can
/// have one. Looks at the alpha channel or at all others.
absl::Status CheckTexels(const ImageFile& file, bool alpha);

/// Whether the last of the file's channels is its alpha: gray and alpha, or RGBA.
bool HasAlpha(const ImageFile& file);
/// Whether it has one and that is not 1 everywhere.
bool IsTranslucent(const ImageFile& file);

/// Linear values of the 256 codes of 8-bit images, correctly rounded.
using DecodeTable = std::array<float, 256>;

/// `gamma` matters for kGamma alone. sRGB is IEC 61966-2-1.
DecodeTable MakeDecodeTable(ImageEncoding encoding, float gamma);
/// One value in [0, 1], as the table would have it.
double Decode(double value, ImageEncoding encoding, float gamma);

/// The pixels of an image, row 0 at the top, as compact as the file: 8-bit codes stay 8-bit.
struct ImageTexels {
  int width = 0, height = 0;
  int channels = 0;            ///< 1 or 3; colours come without their alpha.
  std::vector<uint8_t> codes;  ///< Either these, to be decoded when looked up,
  std::vector<float> values;   ///< or these, linear.

  /// 16-bit integers are decoded by `encoding` here.
  static ImageTexels From(const ImageFile& file, ImageEncoding encoding, float gamma);
  /// The alpha channel alone, as it is stored; 1 where the file has none.
  static ImageTexels AlphaFrom(const ImageFile& file);

  size_t Offset(int x, int y) const { return (static_cast<size_t>(y) * width + x) * channels; }
  /// Of the whole image, and of the numbers of a texel.
  const void* data() const {
    return codes.empty() ? static_cast<const void*>(values.data()) : codes.data();
  }
  size_t TexelBytes() const {
    return static_cast<size_t>(channels) * (codes.empty() ? sizeof(float) : 1);
  }
  Rgb At(int x, int y, const DecodeTable& table) const { return At(Offset(x, y), table); }
  Rgb At(size_t i, const DecodeTable& table) const {
    if (!codes.empty()) {
      const uint8_t* code = &codes[i];
      if (channels == 1) return Rgb::Gray(table[code[0]]);
      return {table[code[0]], table[code[1]], table[code[2]]};
    }
    const float* value = &values[i];
    if (channels == 1) return Rgb::Gray(value[0]);
    return {value[0], value[1], value[2]};
  }
};

}  // namespace strata
