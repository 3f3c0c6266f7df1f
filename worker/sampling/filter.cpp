#include "worker/sampling/filter.h"

#include <cmath>

#include "worker/math/elementary.h"

namespace strata {
namespace {

double Gaussian(double x, double sigma) { return Exp(-0.5 * (x / sigma) * (x / sigma)); }

/// Mitchell and Netravali 1988, on [-2, 2].
double Mitchell(double x, double b, double c) {
  x = std::fabs(x);
  if (x >= 2) return 0;
  if (x >= 1) {
    return ((-b - 6 * c) * x * x * x + (6 * b + 30 * c) * x * x + (-12 * b - 48 * c) * x +
            (8 * b + 24 * c)) /
           6;
  }
  return ((12 - 9 * b - 6 * c) * x * x * x + (-18 + 12 * b + 6 * c) * x * x + (6 - 2 * b)) / 6;
}

struct Node {
  double x, value;
};

/// The filter at nodes from -radius to radius, up to a factor.
std::vector<Node> Tabulate(FilterKind kind, double radius, const FilterSpec& spec) {
  if (kind == FilterKind::kBox) return {{-radius, 1}, {radius, 1}};
  if (kind == FilterKind::kTriangle) return {{-radius, 0}, {0, 1}, {radius, 0}};
  constexpr int kCells = 128;
  std::vector<Node> nodes;
  for (int i = 0; i <= kCells; ++i) {
    const double t = static_cast<double>(2 * i - kCells) / kCells;
    const double x = t * radius;
    const double value = kind == FilterKind::kGaussian
                             ? std::max(0.0, Gaussian(x, spec.sigma) - Gaussian(radius, spec.sigma))
                             : Mitchell(2 * t, spec.b, spec.c);
    // Where the sign changes a node of value 0 keeps each cell of one sign.
    if (!nodes.empty() && nodes.back().value * value < 0) {
      const Node last = nodes.back();
      const double fraction = last.value / (last.value - value);
      nodes.push_back({last.x + fraction * (x - last.x), 0});
    }
    nodes.push_back({x, value});
  }
  return nodes;
}

}  // namespace

FilterAxis::FilterAxis(FilterKind kind, double radius, const FilterSpec& spec) {
  const std::vector<Node> nodes = Tabulate(kind, radius, spec);
  std::vector<double> areas;
  double total = 0;
  for (size_t i = 0; i + 1 < nodes.size(); ++i) {
    const Node a = nodes[i], b = nodes[i + 1];
    areas.push_back(0.5 * (std::fabs(a.value) + std::fabs(b.value)) * (b.x - a.x));
    total += areas.back();
    cells_.push_back({.start = static_cast<float>(a.x),
                      .width = static_cast<float>(b.x - a.x),
                      .first = static_cast<float>(std::fabs(a.value)),
                      .last = static_cast<float>(std::fabs(b.value)),
                      .weight = a.value + b.value < 0 ? -1.0f : 1.0f});
  }
  choice_ = PiecewiseConstant1D(areas);
  scale_ = static_cast<float>(1 / total);
  // The probabilities are exact binary fractions, so this makes the mean weight 1.
  double mean_sign = 0;
  for (size_t i = 0; i < cells_.size(); ++i) {
    mean_sign += cells_[i].weight * choice_.Probability(static_cast<int>(i));
  }
  for (Cell& cell : cells_) cell.weight = static_cast<float>(cell.weight / mean_sign);
}

float FilterAxis::Eval(float offset) const {
  for (const Cell& cell : cells_) {
    const float t = (offset - cell.start) / cell.width;
    if (t >= 0 && t < 1) {
      return (cell.first + (cell.last - cell.first) * t) * scale_ * cell.weight;
    }
  }
  return 0;
}

}  // namespace strata
