#pragma once

#include <string>
#include <vector>

#include "common/compare_images.h"

namespace strata {

/// An image to compare, as it was read.
struct DiffImage {
  std::string path;
  ImageLayers layers;
};

/// What weakens the tests, or why there are none: whole sentences.
std::vector<std::string> DiffWarnings(const DiffImage& a, const DiffImage& b,
                                      const ImageDifference& difference);

/// For people: tables and the verdict, line by line.
std::vector<std::string> DiffLines(const DiffImage& a, const DiffImage& b,
                                   const ImageDifference& difference);

/// {"event":"diff",...}: all figures, as docs/command-line.md lists them.
std::string DiffEvent(const DiffImage& a, const DiffImage& b, const ImageDifference& difference,
                      const std::vector<std::string>& warnings);

}  // namespace strata
