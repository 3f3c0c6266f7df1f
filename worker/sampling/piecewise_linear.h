#pragma once

#include <span>
#include <vector>

#include "worker/sampling/distribution.h"

namespace strata {

/// A density on [0, 1) that is linear between n + 1 nodes at equal distances, sampled by inversion:
/// a cell by PiecewiseConstant1D (PBRT A.4.7), and with what is left of u a point of the linear
/// piece (PBRT 2.3.2).
class PiecewiseLinear1D {
 public:
  /// 2 to 2^20 + 1 values at the nodes, finite and not negative; all zero is uniform.
  explicit PiecewiseLinear1D(std::vector<float> nodes);

  int cells() const { return choice_.cells(); }
  float Sample(float u) const;
  /// Density at x in [0, 1).
  float Pdf(float x) const;
  /// The u that Sample takes to x, within 2^-24.
  float Invert(float x) const;

 private:
  int CellOf(float x) const;
  float Width() const { return 1 / static_cast<float>(cells()); }

  std::vector<float> nodes_;
  PiecewiseConstant1D choice_;  ///< Cells by their areas.
};

}  // namespace strata
