#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "tests/statistics/chi_square.h"
#include "tests/statistics/sphere_quadrature.h"
#include "worker/math/vec.h"

// Does a routine that draws directions have the density it claims? Cells of the sphere are cut so
// that a pilot run puts equally many directions into each, however sharp the lobes are; then the
// counts of a second run are compared with the integral of the density over each cell.

namespace strata {

struct DirectionTestResult {
  ChiSquareResult chi_square;
  double integral = 0;  ///< Of the density over the sphere.
  /// The control, which must fail: the same counts against the density times 1 + error cos(2 pi r),
  /// where r is the share of directions before a cell's ring, from below to above.
  ChiSquareResult control;
  double error = 0;  ///< The control's.
};

inline constexpr double kControlLevel = 1e-6;  ///< A control's p-value must be below this.

namespace direction_test_detail {

/// Polar coordinates of one hemisphere: t = 1 - |z|, exact at the pole, and phi in [-pi, pi].
/// Solid angle is dt dphi.
struct Polar {
  double t, phi;
};
inline Polar ToPolar(Vec3f w) {
  const double r2 = static_cast<double>(w.x) * w.x + static_cast<double>(w.y) * w.y;
  const double z = std::sqrt(std::max(0.0, 1 - r2));
  // Near the horizon z itself is the more accurate.
  const double t = r2 < 0.5 ? r2 / (1 + z) : 1 - std::fabs(static_cast<double>(w.z));
  return {std::clamp(t, 0.0, 1.0), std::atan2(static_cast<double>(w.y), static_cast<double>(w.x))};
}

/// Of a cell's expectation, in standard deviations of the count.
inline constexpr double kQuadratureError = 0.05;

/// The probability of the cell, to a twentieth of the standard deviation of its share of `samples`:
/// errors of that size in all cells add a four-hundredth of the degrees of freedom to the
/// statistic, for 400 of them 1/28 of its standard deviation. What has less than one hit is as if
/// it had one. The parts it is cut into first let quadrature see a corner of a lamp that reaches
/// into an otherwise empty cell; the more samples, the smaller the corner that they find.
template <typename Pdf>
double Probability(const Pdf& pdf, const SphereCell& c, int samples) {
  const int parts_along = samples > 1'000'000 ? 10 : 3;
  std::vector<SphereCell> parts;
  std::vector<double> masses;
  double whole = 0;
  const double t = (c.t1 - c.t0) / parts_along, phi = (c.phi1 - c.phi0) / parts_along;
  for (int i = 0; i < parts_along * parts_along; ++i) {
    const double t0 = c.t0 + i / parts_along * t, phi0 = c.phi0 + i % parts_along * phi;
    parts.push_back({c.upper, t0, t0 + t, phi0, phi0 + phi});
    masses.push_back(GaussIntegral(pdf, parts.back()));
    whole += masses.back();
  }
  const double share = std::clamp(whole, 1.0 / samples, 1.0);
  const double tolerance = kQuadratureError * std::sqrt(share / samples) / parts_along;
  double sum = 0;
  for (size_t i = 0; i < parts.size(); ++i)
    sum += AdaptiveIntegral(pdf, parts[i], masses[i], tolerance);
  return sum;
}

/// Splits intervals until none is more than three times as wide as a neighbour, so that quadrature
/// finds the flanks of a narrow lobe.
inline std::vector<double> Grade(std::vector<double> edges) {
  for (size_t i = 0; i + 1 < edges.size();) {
    const double width = edges[i + 1] - edges[i];
    const double before = i > 0 ? edges[i] - edges[i - 1] : width;
    const double after = i + 2 < edges.size() ? edges[i + 2] - edges[i + 1] : width;
    if (width <= 3 * std::min(before, after)) {
      ++i;
      continue;
    }
    const double split = before < after ? edges[i] + 2 * before : edges[i + 1] - 2 * after;
    edges.insert(edges.begin() + static_cast<std::ptrdiff_t>(i) + 1, split);
    // The part next to this may now be too wide for the one before it.
    if (i > 0) --i;
  }
  return edges;
}

/// Edges that part values into `count` groups of equal size, with the range's ends, graded.
inline std::vector<double> QuantileEdges(std::vector<double> values, int count, double low,
                                         double high) {
  std::sort(values.begin(), values.end());
  std::vector<double> edges = {low};
  // Rounded directions have few different values close to each other.
  const double least = 1e-10 * (high - low);
  for (int i = 1; i < count && !values.empty(); ++i) {
    const double edge = values[values.size() * i / count];
    if (edge > edges.back() + least && edge < high - least) edges.push_back(edge);
  }
  edges.push_back(high);
  return Grade(std::move(edges));
}
inline int FindCell(const std::vector<double>& edges, double x) {
  const auto it = std::upper_bound(edges.begin(), edges.end(), x);
  return std::clamp(static_cast<int>(it - edges.begin()) - 1, 0,
                    static_cast<int>(edges.size()) - 2);
}

/// `expected` times 1 + error * wave, its sum kept. What follows the waves, if anything, is none of
/// theirs.
inline std::vector<double> Tilt(std::vector<double> expected, const std::vector<double>& waves,
                                double error) {
  double before = 0, after = 0;
  for (size_t i = 0; i < waves.size(); ++i) {
    before += expected[i];
    after += expected[i] *= 1 + error * waves[i];
  }
  for (size_t i = 0; i < waves.size(); ++i) expected[i] *= before / after;
  return expected;
}

/// The least error of Tilt that `degrees` of freedom must find.
inline double LeastErrorFound(const std::vector<double>& expected, const std::vector<double>& waves,
                              int degrees) {
  // The statistic's shift at an error of 1.
  const std::vector<double> tilted = Tilt(expected, waves, 0.5);
  double shift = 0;
  for (size_t i = 0; i < waves.size(); ++i) {
    const double off = (tilted[i] - expected[i]) / 0.5;
    shift += off * off / expected[i];
  }
  return std::sqrt(NoncentralityFound(degrees, kControlLevel) / shift);
}

}  // namespace direction_test_detail

/// `sample` draws a direction, or none (which must happen with one minus the integral of `pdf`, the
/// density by solid angle). `samples` are tested after a pilot of a tenth as many. The control's
/// error is `error`, or else the least that so many samples in so many cells must find.
template <typename Sample, typename Pdf>
DirectionTestResult TestDirections(const Sample& sample, const Pdf& pdf, int samples,
                                   std::optional<double> error = std::nullopt) {
  using namespace direction_test_detail;
  constexpr int kRings = 8, kSectors = 8;

  std::vector<Polar> pilot[2];
  for (int i = 0; i < samples / 10; ++i) {
    if (const std::optional<Vec3f> w = sample()) pilot[w->z > 0].push_back(ToPolar(*w));
  }
  struct Hemisphere {
    std::vector<double> rings;
    std::vector<std::vector<double>> sectors;
    std::vector<int> first;  ///< Cell number of each ring's first sector.
  };
  Hemisphere hemispheres[2];
  std::vector<double> expected;
  std::vector<double> waves;  // The shape of the control's error.
  double integral = 0;
  for (const int side : {0, 1}) {
    Hemisphere& hemisphere = hemispheres[side];
    std::vector<double> heights;
    for (const Polar& p : pilot[side]) heights.push_back(p.t);
    hemisphere.rings = QuantileEdges(heights, kRings, 0, 1);
    const int rings = static_cast<int>(hemisphere.rings.size()) - 1;
    std::vector<std::vector<double>> angles(rings);
    for (const Polar& p : pilot[side]) angles[FindCell(hemisphere.rings, p.t)].push_back(p.phi);
    for (int ring = 0; ring < rings; ++ring) {
      hemisphere.sectors.push_back(
          QuantileEdges(angles[ring], kSectors, -std::numbers::pi, std::numbers::pi));
      hemisphere.first.push_back(static_cast<int>(expected.size()));
      const std::vector<double>& edges = hemisphere.sectors.back();
      const double before = integral;
      for (size_t s = 0; s + 1 < edges.size(); ++s) {
        const SphereCell cell = {side == 1, hemisphere.rings[ring], hemisphere.rings[ring + 1],
                                 edges[s], edges[s + 1]};
        const double mass = Probability(pdf, cell, samples);
        integral += mass;
        // Below this the quadrature cannot tell nothing from little.
        expected.push_back(std::max(mass, 1e-8) * samples);
      }
      waves.resize(expected.size(), 0.5 * (before + integral));
    }
  }
  for (double& wave : waves) wave = std::cos(2 * std::numbers::pi * wave / integral);
  expected.push_back(samples * std::max(0.0, 1 - integral));

  std::vector<double> observed(expected.size(), 0.0);
  for (int i = 0; i < samples; ++i) {
    const std::optional<Vec3f> w = sample();
    if (!w) {
      ++observed.back();
      continue;
    }
    const Polar p = ToPolar(*w);
    const Hemisphere& hemisphere = hemispheres[w->z > 0];
    const int ring = FindCell(hemisphere.rings, p.t);
    ++observed[hemisphere.first[ring] + FindCell(hemisphere.sectors[ring], p.phi)];
  }
  // That some are none is no expectation where so few are within the quadrature's error, the same
  // way in each of the cells: what is missing is for a test of the integral to tell.
  const double unsure = kQuadratureError * std::sqrt(static_cast<double>(waves.size()) * samples);
  if (expected.back() < unsure + 5 && observed.back() < 5) {
    expected.pop_back();
    observed.pop_back();
  }
  DirectionTestResult result = {ChiSquareTest(observed, expected), integral, {}, 0};
  if (result.chi_square.degrees < 1) return result;
  result.error = error ? *error : LeastErrorFound(expected, waves, result.chi_square.degrees);
  result.control = ChiSquareTest(observed, Tilt(expected, waves, result.error));
  return result;
}

}  // namespace strata
