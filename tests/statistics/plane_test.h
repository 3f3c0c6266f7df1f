#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/direction_test.h"
#include "tests/statistics/random.h"

// Does a routine that draws points have the density it claims? Points are told in two coordinates
// of a rectangle in which the density is smooth, or jumps along given lines alone: a direction by
// its angles, a point of a disk by radius and angle. Counts of cells are compared with the integral
// of the density over each.

namespace strata {

struct PlanePoint {
  double x = 0, y = 0;
};

/// A routine under test.
struct PlaneCase {
  std::string name;
  /// Draws a point, or none (which must happen with one minus the integral of the density).
  std::function<std::optional<PlanePoint>(TestRandom&)> sample;
  std::function<double(PlanePoint)> density;  ///< By dx dy.
  /// The shape of the control's error, in [-1, 1]. Its mean under the density is taken off.
  std::function<double(PlanePoint)> tilt;
  double x0 = 0, x1 = 1, y0 = 0, y1 = 1;
  /// Edges of the cells; empty: equally many points between them. The density may jump there.
  std::vector<double> x_edges, y_edges;
};

inline void PrintTo(const PlaneCase& c, std::ostream* out) { *out << c.name; }

struct PlaneTestResult {
  ChiSquareResult chi_square;
  double integral = 0;  ///< Of the density.
};

namespace plane_test_detail {

/// By six by six Gauss-Legendre points in each of four by four parts.
template <typename Function>
double Integrate(const Function& f, double x0, double x1, double y0, double y1) {
  constexpr std::array<double, 3> kNodes = {0.2386191860831969, 0.6612093864662645,
                                            0.9324695142031521};
  constexpr std::array<double, 3> kWeights = {0.4679139345726910, 0.3607615730481386,
                                              0.1713244923791704};
  constexpr int kParts = 4;
  const double xh = 0.5 * (x1 - x0) / kParts, yh = 0.5 * (y1 - y0) / kParts;
  const auto place = [&](double start, double half, int i) {
    const int node = i % 6;
    return start + half * (2 * (i / 6) + 1 + (node % 2 ? kNodes[node / 2] : -kNodes[node / 2]));
  };
  double sum = 0;
  for (int i = 0; i < 6 * kParts; ++i) {
    for (int j = 0; j < 6 * kParts; ++j) {
      sum += kWeights[i % 6 / 2] * kWeights[j % 6 / 2] *
             f(PlanePoint{place(x0, xh, i), place(y0, yh, j)});
    }
  }
  return sum * xh * yh;
}

}  // namespace plane_test_detail

/// `samples` points against the density times 1 + error * tilt, so that an error above 0 is the
/// control, which must be found. Cells come from a pilot of 10000 points.
inline PlaneTestResult TestPlane(const PlaneCase& c, int samples, double error, uint64_t seed) {
  constexpr int kCells = 8, kPilot = 10000;
  TestRandom random(seed);
  std::vector<double> xs, ys;
  for (int i = 0; i < kPilot; ++i) {
    const std::optional<PlanePoint> p = c.sample(random);
    if (!p) continue;
    xs.push_back(p->x);
    ys.push_back(p->y);
  }
  using direction_test_detail::FindCell, direction_test_detail::QuantileEdges;
  const auto x_edges = c.x_edges.empty() ? QuantileEdges(xs, kCells, c.x0, c.x1) : c.x_edges;
  const auto y_edges = c.y_edges.empty() ? QuantileEdges(ys, kCells, c.y0, c.y1) : c.y_edges;
  const size_t columns = x_edges.size() - 1, rows = y_edges.size() - 1;

  PlaneTestResult result;
  std::vector<double> expected;
  double claimed = 0;
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < columns; ++column) {
      const auto integral = [&](const auto& f) {
        return plane_test_detail::Integrate(f, x_edges[column], x_edges[column + 1], y_edges[row],
                                            y_edges[row + 1]);
      };
      const double mass = integral(c.density);
      result.integral += mass;
      const double tilted = error == 0 ? mass : integral([&](PlanePoint p) {
        const double density = c.density(p);
        return density > 0 ? density * (1 + error * c.tilt(p)) : 0;
      });
      claimed += tilted;
      expected.push_back(tilted * samples);
    }
  }
  for (double& e : expected) e *= result.integral / claimed;
  std::vector<double> observed(expected.size() + 1, 0.0);
  for (int i = 0; i < samples; ++i) {
    const std::optional<PlanePoint> p = c.sample(random);
    ++observed[p ? FindCell(y_edges, p->y) * columns + FindCell(x_edges, p->x) : expected.size()];
  }
  const double none = samples * std::max(0.0, 1 - result.integral);
  // The quadrature's error in all cells is no expectation, as in TestDirections.
  const double unsure = direction_test_detail::kQuadratureError *
                        std::sqrt(static_cast<double>(expected.size()) * samples);
  if (none < unsure + 5 && observed.back() < 5) {
    observed.pop_back();
  } else {
    expected.push_back(none);
  }
  result.chi_square = ChiSquareTest(observed, expected);
  return result;
}

}  // namespace strata
