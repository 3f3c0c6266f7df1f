#pragma once

#include <string_view>
#include <vector>

namespace strata::lab {

/// Points of [0, 1] and their weights, which sum to 1.
struct GridRule {
  std::vector<double> nodes, weights;
};

enum class RuleKind { kRectangle, kTrapezoid, kSimpson, kGauss };

std::string_view ToString(RuleKind kind);

/// A composite rule over `intervals` equal intervals; Simpson's takes an even number of them.
/// Gauss-Legendre has as many nodes instead, by Newton's method on the Legendre polynomial.
GridRule MakeRule(RuleKind kind, int intervals);

/// The most intervals, 1 or more (2 for Simpson's), whose grid in `dimensions` has at most
/// `evaluations` points; 0 when there is none.
int MostIntervals(RuleKind kind, int dimensions, double evaluations);
/// Points of the rule on one axis.
int NodesOf(RuleKind kind, int intervals);

/// How the error falls with the evaluations n: as n^-OrderOf(kind, dimensions), poorly in many
/// dimensions (PBRT, chapter 2). Gauss-Legendre has none: it falls faster than any power.
double OrderOf(RuleKind kind, int dimensions);

}  // namespace strata::lab
