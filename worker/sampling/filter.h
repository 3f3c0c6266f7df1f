#pragma once

#include <vector>

#include "common/job.h"
#include "worker/math/vec.h"
#include "worker/sampling/distribution.h"
#include "worker/sampling/inversion.h"

namespace strata {

/// Where in the filter a sample of a pixel lies.
struct FilterSample {
  Vec2f offset;      ///< From the pixel's centre, in pixels.
  float weight = 1;  ///< Of the sample's value: 1, or +-a constant for filters with negative lobes.
};

/// One axis of a separable filter as a function that is linear between nodes, sampled in proportion
/// to its magnitude. Box and triangle are exact; the others follow pbrt-v4's definitions to 1e-3 of
/// their peak.
class FilterAxis {
 public:
  FilterAxis(FilterKind kind, double radius, const FilterSpec& spec);

  struct Point {
    float offset, weight;
  };
  Point Sample(float u) const {
    if (cells_.size() == 1) {  // The box; u stands for the middle of its 2^-24.
      return {cells_[0].start + cells_[0].width * (u + 0x1p-25f), cells_[0].weight};
    }
    const PiecewiseConstant1D::Choice chosen = choice_.Choose(u);
    const Cell& cell = cells_[chosen.cell];
    const float within = SampleLinear(chosen.fraction, cell.first, cell.last);
    return {cell.start + cell.width * within, cell.weight};
  }
  /// The filter divided by its integral: weight times density of the samples.
  float Eval(float offset) const;

 private:
  struct Cell {
    float start, width;  ///< In pixels.
    float first, last;   ///< Magnitudes at its ends, of one sign inside.
    float weight;
  };
  std::vector<Cell> cells_;
  PiecewiseConstant1D choice_;
  float scale_ = 1;  ///< Of magnitudes to density.
};

/// Filter importance sampling: a sample belongs to one pixel, and weights average to 1, so that a
/// constant image stays constant.
class FilterSampler {
 public:
  /// `spec` has passed ValidateJobSpec.
  explicit FilterSampler(const FilterSpec& spec)
      : x_(spec.kind, spec.radius_x, spec), y_(spec.kind, spec.radius_y, spec) {}

  FilterSample Sample(Vec2f u) const {
    const FilterAxis::Point x = x_.Sample(u.x), y = y_.Sample(u.y);
    return {{x.offset, y.offset}, x.weight * y.weight};
  }
  /// The normalised filter at an offset.
  float Eval(Vec2f offset) const { return x_.Eval(offset.x) * y_.Eval(offset.y); }

 private:
  FilterAxis x_, y_;
};

}  // namespace strata
