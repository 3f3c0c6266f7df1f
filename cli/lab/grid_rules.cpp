#include "cli/lab/grid_rules.h"

#include <cmath>
#include <numbers>

namespace strata::lab {
namespace {

/// Nodes on [-1, 1] are the zeros of the Legendre polynomial P_n, which Newton's method finds from
/// cos(pi (i + 3/4) / (n + 1/2)); weights are 2 / ((1 - x^2) P_n'(x)^2).
GridRule GaussLegendre(int n) {
  GridRule rule;
  for (int i = n - 1; i >= 0; --i) {
    double x = std::cos(std::numbers::pi * (i + 0.75) / (n + 0.5)), derivative = 0;
    for (int step = 0; step < 100; ++step) {
      double before = 1, value = x;  // P_0 and P_1.
      for (int k = 2; k <= n; ++k) {
        const double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
        before = value;
        value = next;
      }
      derivative = n * (x * value - before) / (x * x - 1);
      const double change = value / derivative;
      x -= change;
      if (std::fabs(change) < 1e-15) break;
    }
    rule.nodes.push_back(0.5 * (1 + x));
    rule.weights.push_back(1 / ((1 - x * x) * derivative * derivative));
  }
  return rule;
}

}  // namespace

std::string_view ToString(RuleKind kind) {
  switch (kind) {
    case RuleKind::kRectangle:
      return "rectangle";
    case RuleKind::kTrapezoid:
      return "trapezoid";
    case RuleKind::kSimpson:
      return "Simpson";
    case RuleKind::kGauss:
      return "Gauss-Legendre";
  }
  return "";
}

int NodesOf(RuleKind kind, int intervals) {
  const bool closed = kind == RuleKind::kTrapezoid || kind == RuleKind::kSimpson;
  return closed ? intervals + 1 : intervals;
}

GridRule MakeRule(RuleKind kind, int intervals) {
  if (kind == RuleKind::kGauss) return GaussLegendre(intervals);
  GridRule rule;
  const int nodes = NodesOf(kind, intervals);
  for (int i = 0; i < nodes; ++i) {
    const bool end = i == 0 || i == intervals;
    double weight = 1;
    if (kind == RuleKind::kTrapezoid) weight = end ? 0.5 : 1;
    if (kind == RuleKind::kSimpson) weight = (end ? 1.0 : i % 2 ? 4.0 : 2.0) / 3;
    rule.nodes.push_back(static_cast<double>(i) / intervals);
    rule.weights.push_back(weight / intervals);
  }
  return rule;
}

int MostIntervals(RuleKind kind, int dimensions, double evaluations) {
  const int step = kind == RuleKind::kSimpson ? 2 : 1;
  const auto fits = [&](int intervals) {
    return std::pow(NodesOf(kind, intervals), dimensions) <= evaluations * (1 + 1e-9);
  };
  // Gauss-Legendre converges so fast that more nodes only cost the time to find them.
  const int limit = kind == RuleKind::kGauss ? 64 : 1 << 30;
  int low = 0, high = step;  // In steps: `low` fits, `high` is tried.
  while (high <= limit && fits(high)) {
    low = high;
    high *= 2;
  }
  for (int jump = low / 2 / step * step; jump >= step; jump = jump / 2 / step * step) {
    while (low + jump <= limit && fits(low + jump)) low += jump;
  }
  return low;
}

double OrderOf(RuleKind kind, int dimensions) {
  switch (kind) {
    case RuleKind::kRectangle:
      return 1.0 / dimensions;
    case RuleKind::kTrapezoid:
      return 2.0 / dimensions;
    case RuleKind::kSimpson:
      return 4.0 / dimensions;
    case RuleKind::kGauss:
      break;
  }
  return NAN;
}

}  // namespace strata::lab
