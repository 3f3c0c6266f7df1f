#pragma once

#include <algorithm>
#include <vector>

#include "worker/integrator/render.h"

namespace strata {

/// The throughput from which on a path surely goes on (PathSettings::sure_survival), for each part
/// of a frame.
class RouletteMap {
 public:
  /// The same everywhere.
  RouletteMap(int width, int height, float sure)
      : width_(width),
        height_(height),
        columns_(Cells(width)),
        rows_(Cells(height)),
        sure_(static_cast<size_t>(columns_) * rows_, sure) {}

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  float& Cell(int column, int row) { return sure_[static_cast<size_t>(row) * columns_ + column]; }
  /// The first pixel of a column, and of a row; that of `columns()` is one past the last.
  int ColumnBegin(int column) const { return (column * width_ + columns_ - 1) / columns_; }
  int RowBegin(int row) const { return (row * height_ + rows_ - 1) / rows_; }
  /// At a pixel of the frame.
  float At(int x, int y) const {
    return sure_[static_cast<size_t>(y * rows_ / height_) * columns_ + x * columns_ / width_];
  }

 private:
  static int Cells(int pixels) {
    constexpr int kMost = 16, kLeastPixels = 8;
    return std::clamp(pixels / kLeastPixels, 1, kMost);
  }

  int width_, height_, columns_, rows_;
  std::vector<float> sure_;
};

/// Efficiency-optimised roulette. Let V be the variance of a sample and C its rays; a path of
/// throughput b that would find L for each unit of b, with so many rays c more, should survive with
/// probability b sqrt(E[L^2] / c) / sqrt(V / C), for then 1 / (V C) is greatest (Rath et al. 2022,
/// "EARS", after Veach 1997, 10.4.1; for shadow rays PBRT 3rd ed. 13.7.1). So paths survive surely
/// from b = sqrt(V / C) / sqrt(E[L^2] / c) on, which is kept within 1/4 and 1.
///
/// V and C are those of the pixel's part of the frame and those beside it, E[L^2] and c of the
/// whole frame, from a pilot of some thousand paths. The pilot has random numbers that no job's
/// samples have and depends on neither seed, crop nor units: every worker finds the same bits, and
/// whatever it finds, samples stay unbiased and independent of each other given it.
RouletteMap MeasureRoulette(const Renderer::State& job);

}  // namespace strata
