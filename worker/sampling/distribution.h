#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "worker/math/vec.h"

namespace strata {

/// A density on [0, 1) that is constant in each of n cells of equal width, sampled by inversion.
///
/// Random numbers are multiples of 2^-24, so probabilities are too: each cell owns a whole number
/// of the 2^24 points, at least one if its weight is positive. Density and samples agree exactly,
/// and no cell is missed however dim it is.
class PiecewiseConstant1D {
 public:
  /// What u became: a point and the cell it lies in.
  struct Point {
    float x;  ///< In [0, 1).
    int cell;
    float fraction;     ///< Where in the cell, in (0, 1): the rest of u, still uniform.
    float probability;  ///< Of the cell.
  };

  /// One cell.
  PiecewiseConstant1D() : PiecewiseConstant1D(std::vector<double>{1}) {}
  /// 1 to 2^20 cells; weights that are not positive and finite count as 0; all zero is uniform.
  explicit PiecewiseConstant1D(std::span<const double> weights);

  int cells() const { return static_cast<int>(starts_.size()) - 1; }
  Point Sample(float u) const;
  float Probability(int cell) const {
    return static_cast<float>(starts_[cell + 1] - starts_[cell]) * 0x1p-24f;
  }
  /// Density at x in [0, 1).
  float Pdf(float x) const {
    const int cell = static_cast<int>(x * static_cast<float>(cells()));
    return Probability(std::clamp(cell, 0, cells() - 1)) * static_cast<float>(cells());
  }

 private:
  std::vector<uint32_t> starts_;  ///< First point of each cell; ends with 2^24.
};

/// The same on the unit square: rows by their sums (y), then a cell of the row (x). Its tables take
/// 4 bytes a cell.
class PiecewiseConstant2D {
 public:
  /// One cell.
  PiecewiseConstant2D() : PiecewiseConstant2D(std::vector<float>{1}, 1, 1) {}
  /// `weights` row by row, row 0 at y = 0; width and height as the cells of PiecewiseConstant1D.
  PiecewiseConstant2D(std::span<const float> weights, int width, int height);

  /// The point's density goes to `pdf`.
  Vec2f Sample(Vec2f u, float* pdf) const;
  /// Density at a point of [0, 1)^2.
  float Pdf(Vec2f point) const;

 private:
  PiecewiseConstant1D rows_;
  int width_;
  std::vector<uint32_t> starts_;  ///< width + 1 for each row.
};

}  // namespace strata
