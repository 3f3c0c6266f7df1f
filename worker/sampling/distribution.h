#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "worker/math/vec.h"
#include "worker/sampling/choose.h"

namespace strata {

/// A density on [0, 1) that is constant in each of n cells of equal width, sampled by inversion
/// (PBRT A.4.7).
///
/// Random numbers are multiples of 2^-24, so probabilities are too: each cell owns a whole number
/// of the 2^24 points, at least one if its weight is positive. Density and samples agree exactly,
/// and no cell is missed however dim it is.
class PiecewiseConstant1D {
 public:
  static constexpr uint32_t kPoints = 1u << 24;  ///< Random numbers there are.

  /// The cell u falls in.
  struct Choice {
    int cell;
    float fraction;     ///< Where in the cell, in (0, 1): the rest of u, still uniform.
    float probability;  ///< Of the cell.
  };
  struct Point {
    float x;  ///< In [0, 1).
    Choice choice;
  };

  /// One cell.
  PiecewiseConstant1D() : PiecewiseConstant1D(std::vector<double>{1}) {}
  /// 1 to 2^20 cells; weights that are not positive and finite count as 0; all zero is uniform.
  explicit PiecewiseConstant1D(std::span<const double> weights);

  int cells() const { return static_cast<int>(starts_.size()) - 1; }
  Choice Choose(float u) const {
    const uint32_t point = PointOf(u);
    uint32_t cell = guide_[point >> guide_shift_];
    while (starts_[cell + 1] <= point) ++cell;
    return ChoiceOf(starts_.data(), cell, point);
  }
  Point Sample(float u) const;
  float Probability(int cell) const {
    return static_cast<float>(starts_[cell + 1] - starts_[cell]) * 0x1p-24f;
  }
  /// Where the numbers that choose the cell begin.
  float Start(int cell) const { return static_cast<float>(starts_[cell]) * 0x1p-24f; }
  /// The u that Sample takes to x, within 2^-24.
  float Invert(float x) const;
  /// Density at x in [0, 1).
  float Pdf(float x) const {
    const int cell = static_cast<int>(x * static_cast<float>(cells()));
    return Probability(std::clamp(cell, 0, cells() - 1)) * static_cast<float>(cells());
  }

 private:
  friend class PiecewiseConstant2D;

  static uint32_t PointOf(float u) {
    return std::min(static_cast<uint32_t>(u * 0x1p24f), kPoints - 1);
  }
  /// `point` lies in `cell` of those that begin at `starts`.
  static Choice ChoiceOf(const uint32_t* starts, uint32_t cell, uint32_t point) {
    const float count = static_cast<float>(starts[cell + 1] - starts[cell]);
    const float fraction = (static_cast<float>(point - starts[cell]) + 0.5f) / count;
    return {static_cast<int>(cell), std::min(fraction, kBelowOne), count * 0x1p-24f};
  }

  std::vector<uint32_t> starts_;  ///< First point of each cell; ends with 2^24.
  /// Where to begin the search: the cell of the first point of each of 2^k equal stretches, about
  /// one for each cell (the cutpoint method; Chen and Asau 1974).
  std::vector<uint32_t> guide_;
  uint32_t guide_shift_ = 0;
};

/// The same on the unit square (PBRT A.5.5): rows by their sums (y), then a cell of the row (x).
/// Its tables take 4 bytes a cell.
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
  /// The u that Sample takes to the point, within 2^-24.
  Vec2f Invert(Vec2f point) const;

 private:
  PiecewiseConstant1D rows_;
  int width_;
  std::vector<uint32_t> starts_;  ///< width + 1 for each row.
};

}  // namespace strata
