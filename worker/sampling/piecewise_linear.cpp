#include "worker/sampling/piecewise_linear.h"

#include <algorithm>

#include "worker/sampling/choose.h"
#include "worker/sampling/inversion.h"

namespace strata {
namespace {

std::vector<float> OrUniform(std::vector<float> nodes) {
  const bool none = std::all_of(nodes.begin(), nodes.end(), [](float v) { return !(v > 0); });
  if (none) std::fill(nodes.begin(), nodes.end(), 1.0f);
  return nodes;
}

std::vector<double> TrapezoidAreas(const std::vector<float>& nodes) {
  std::vector<double> areas;
  for (size_t i = 0; i + 1 < nodes.size(); ++i) {
    areas.push_back(0.5 * (static_cast<double>(nodes[i]) + nodes[i + 1]));
  }
  return areas;
}

}  // namespace

PiecewiseLinear1D::PiecewiseLinear1D(std::vector<float> nodes)
    : nodes_(OrUniform(std::move(nodes))), choice_(TrapezoidAreas(nodes_)) {}

int PiecewiseLinear1D::CellOf(float x) const {
  return std::clamp(static_cast<int>(x * static_cast<float>(cells())), 0, cells() - 1);
}

float PiecewiseLinear1D::Sample(float u) const {
  const PiecewiseConstant1D::Choice chosen = choice_.Choose(u);
  const float within = SampleLinear(chosen.fraction, nodes_[chosen.cell], nodes_[chosen.cell + 1]);
  return std::min((static_cast<float>(chosen.cell) + within) * Width(), kBelowOne);
}

float PiecewiseLinear1D::Pdf(float x) const {
  const int cell = CellOf(x);
  const float probability = choice_.Probability(cell);
  if (probability == 0) return 0;  // Both of its nodes are 0.
  const float t = x * static_cast<float>(cells()) - static_cast<float>(cell);
  return probability * static_cast<float>(cells()) * LinearPdf(t, nodes_[cell], nodes_[cell + 1]);
}

float PiecewiseLinear1D::Invert(float x) const {
  const int cell = CellOf(x);
  if (choice_.Probability(cell) == 0) return choice_.Start(cell);
  const float t = x * static_cast<float>(cells()) - static_cast<float>(cell);
  return choice_.Start(cell) +
         choice_.Probability(cell) * InvertLinear(t, nodes_[cell], nodes_[cell + 1]);
}

}  // namespace strata
