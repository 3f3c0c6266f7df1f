#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "common/report.h"
#include "common/status.h"

// Images in files, through OpenImageIO, which no other module sees.

namespace strata {

/// Pixels of an image file, row 0 at the top, interleaved.
struct ImageFile {
  int width = 0, height = 0, channels = 0;
  std::vector<std::string> channel_names;
  bool eight_bit = false;      ///< The file held 8-bit integers; `values` are then in [0, 1], as stored (not linearized).
  std::vector<float> values;
};

/// NOT_FOUND when there is no such file, INVALID_ARGUMENT when it is no image OpenImageIO reads.
absl::StatusOr<ImageFile> ReadImageFile(const std::filesystem::path& path);

/// OpenEXR, 32-bit float, zip; channel names as given; the crop as data window, metadata as header
/// attributes "strata:NAME". Writes to a temporary name and renames.
absl::Status WriteExr(const std::filesystem::path& path, const ImageLayers& image);

/// 8-bit sRGB of R, G, B for looking: exposure so that most of the picture is in range, highlights
/// rolled off; the curve is documented in docs.
absl::Status WritePng(const std::filesystem::path& path, const ImageLayers& image);

}  // namespace strata
