#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/report.h"
#include "common/status.h"

// Images in files, through OpenImageIO, which no other module sees.

namespace strata {

/// Pixels of an image file, row 0 at the top, interleaved.
struct ImageFile {
  int width = 0, height = 0, channels = 0;
  std::vector<std::string> channel_names;
  bool eight_bit = false;    ///< The file held 8-bit integers; `values` are then in [0, 1], as
                             ///< stored (not linearized).
  bool sixteen_bit = false;  ///< The same of 16-bit integers. Neither: floating point, linear.
  std::vector<float> values;
};

/// Reads the first image of the file: PNG, JPEG, TGA, BMP, Radiance HDR, OpenEXR, PFM, TIFF and
/// what else OpenImageIO knows by the file's extension or content. NOT_FOUND when there is no such
/// file, INVALID_ARGUMENT when it is no image, is cut short, or claims a size beyond 65536 pixels
/// on an edge, 64 channels, 2^30 values or what a file of its length can hold.
absl::StatusOr<ImageFile> ReadImageFile(const std::filesystem::path& path);

/// The same of PNG or JPEG bytes in memory; `name` is what errors call them.
absl::StatusOr<ImageFile> ReadImageBytes(const std::string& name, std::string_view bytes);

/// OpenEXR, 32-bit float, zip; channel names as given; the crop as data window, metadata as header
/// attributes "strata:NAME". Writes to a temporary name and renames; UNKNOWN, with the path and the
/// reason, when that fails.
absl::Status WriteExr(const std::filesystem::path& path, const ImageLayers& image);

/// Reads back what WriteExr wrote, or any other OpenEXR file: its channels, those of no layer
/// first, its windows, and the attributes "strata:NAME" without their prefix.
absl::StatusOr<ImageLayers> ReadExr(const std::filesystem::path& path);

/// 8-bit sRGB of the crop's R, G and B, for looking. Exposure is 1, as in other viewers, so that
/// two pictures of a scene compare; each channel passes ToneMap. Writes as WriteExr does.
absl::Status WritePng(const std::filesystem::path& path, const ImageLayers& image);

/// The curve of WritePng, in [0, 1): x as it is up to 0.8, then highlights are rolled off smoothly
/// as 0.8 + 0.2 y / (1 + y) with y = (x - 0.8) / 0.2: 1 becomes 0.9, 10 becomes 0.996. Negative
/// values and NaN become 0.
float ToneMap(float x);

}  // namespace strata
