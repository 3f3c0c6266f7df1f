#pragma once

#include <cstdint>
#include <vector>

#include "common/report.h"
#include "coordinator/estimate.h"

namespace strata {

/// Figures of a whole picture; see JobStatus.
struct FilmSummary {
  double rel_error = 0;
  double flagged = 0;
  double mean_rgb[kColours] = {};
  std::vector<TileError> worst_tiles;
};

/// What a summary needs of each pixel, kept so that a picture in progress is summed up anew after
/// estimating only the tiles that changed. Not thread-safe.
class SummaryInput {
 public:
  explicit SummaryInput(const TileGrid& grid);

  /// Replaces the estimates of a tile, as Estimate gives them for its rectangle.
  void Update(uint32_t tile, const std::vector<PixelEstimate>& estimates);

  /// Sums run in pixel order over the values as they stand in the picture (floats), so that the
  /// figures do not depend on the tile size; `worst_tiles` alone do.
  /// Intervals are `widening` times those of the estimates.
  FilmSummary Summarize(double widening) const;

 private:
  struct Pixel {
    float mean[kColours] = {};
    float ci95[kColours] = {};
    uint32_t flags = 0;
    bool has_samples = false;
  };
  size_t IndexOf(int x, int y) const;
  std::vector<TileError> WorstTiles(double least_luminance, double widening) const;

  TileGrid grid_;
  std::vector<Pixel> pixels_;  ///< Row-major over the crop.
};

}  // namespace strata
