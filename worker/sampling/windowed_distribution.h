#pragma once

#include <span>
#include <vector>

#include "worker/math/vec.h"

namespace strata {

/// A part of the unit square: low <= point < high in both coordinates.
struct Window {
  Vec2f low = {0, 0}, high = {1, 1};

  bool Contains(Vec2f p) const {
    return p.x >= low.x && p.x < high.x && p.y >= low.y && p.y < high.y;
  }
};

/// A piecewise constant density on the unit square that can be restricted to any window at no cost
/// beforehand, by a table of sums (PBRT A.5.6).
class WindowedDistribution {
 public:
  WindowedDistribution() : WindowedDistribution(std::vector<float>{1}, 1, 1) {}
  /// `weights` row by row, row 0 at y = 0. Weights that are not positive and finite count as 0; all
  /// zero is uniform.
  WindowedDistribution(std::span<const float> weights, int width, int height);

  /// A point of the window, with its density within it; that is 0 where nothing can be chosen.
  Vec2f Sample(const Window& window, Vec2f u, float* pdf) const;
  /// Density of a point, given the window; 0 outside of it.
  float Pdf(const Window& window, Vec2f point) const;

 private:
  /// The integral from the origin to (x, y), both in cells.
  double Integral(double x, double y) const;
  double Corner(int x, int y) const { return sums_[static_cast<size_t>(y) * (width_ + 1) + x]; }
  double Mass(const Window& window) const;
  double Weight(Vec2f point) const;

  int width_, height_;
  std::vector<double> sums_;  ///< Over the cells before each corner; (width + 1) (height + 1).
};

}  // namespace strata
