#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "worker/math/vec.h"

// Integrals over the sphere of functions that may have sharp lobes and jumps.

namespace strata {

/// A part of one hemisphere: t = 1 - |z| in [t0, t1], phi in [phi0, phi1]. Solid angle is dt dphi.
struct SphereCell {
  bool upper;
  double t0, t1, phi0, phi1;
};

/// The integral of f(Vec3f) over the cell by six by six Gauss-Legendre points.
template <typename Function>
double GaussIntegral(const Function& f, const SphereCell& c) {
  const double tm = 0.5 * (c.t0 + c.t1), th = 0.5 * (c.t1 - c.t0);
  const double pm = 0.5 * (c.phi0 + c.phi1), ph = 0.5 * (c.phi1 - c.phi0);
  constexpr std::array<double, 3> kNodes = {0.2386191860831969, 0.6612093864662645,
                                            0.9324695142031521};
  constexpr std::array<double, 3> kWeights = {0.4679139345726910, 0.3607615730481386,
                                              0.1713244923791704};
  struct Turn {
    double cos, sin;
  };
  std::array<Turn, 6> turns;
  for (int j = 0; j < 6; ++j) {
    const double phi = pm + (j % 2 ? ph : -ph) * kNodes[j / 2];
    turns[j] = {std::cos(phi), std::sin(phi)};
  }
  double sum = 0;
  for (int i = 0; i < 6; ++i) {
    const double t = tm + (i % 2 ? th : -th) * kNodes[i / 2];
    const double s = std::sqrt(t * (2 - t));
    const auto z = static_cast<float>(c.upper ? 1 - t : t - 1);
    double row = 0;
    for (int j = 0; j < 6; ++j) {
      const Vec3f w = {static_cast<float>(s * turns[j].cos), static_cast<float>(s * turns[j].sin),
                       z};
      row += kWeights[j / 2] * static_cast<double>(f(w));
    }
    sum += kWeights[i / 2] * row;
  }
  return sum * th * ph;
}

/// Halves the cell along the axis where that changes the integral more, until neither changes it by
/// `tolerance`. `whole` is its GaussIntegral. Lobes at a pole and jumps along a circle need finer
/// steps along one axis alone.
template <typename Function>
double AdaptiveIntegral(const Function& f, const SphereCell& c, double whole, double tolerance,
                        int depth = 24) {
  const double tm = 0.5 * (c.t0 + c.t1), pm = 0.5 * (c.phi0 + c.phi1);
  const std::array<SphereCell, 2> by_t = {
      {{c.upper, c.t0, tm, c.phi0, c.phi1}, {c.upper, tm, c.t1, c.phi0, c.phi1}}};
  const std::array<SphereCell, 2> by_phi = {
      {{c.upper, c.t0, c.t1, c.phi0, pm}, {c.upper, c.t0, c.t1, pm, c.phi1}}};
  const std::array<double, 2> t = {GaussIntegral(f, by_t[0]), GaussIntegral(f, by_t[1])};
  const std::array<double, 2> phi = {GaussIntegral(f, by_phi[0]), GaussIntegral(f, by_phi[1])};
  const double t_change = std::fabs(t[0] + t[1] - whole);
  const double phi_change = std::fabs(phi[0] + phi[1] - whole);
  const bool choose_t = t_change > phi_change;
  const std::array<SphereCell, 2>& halves = choose_t ? by_t : by_phi;
  const std::array<double, 2>& values = choose_t ? t : phi;
  if (depth == 0 || std::max(t_change, phi_change) < tolerance) return values[0] + values[1];
  const double share = std::numbers::sqrt2 / 2 * tolerance;
  return AdaptiveIntegral(f, halves[0], values[0], share, depth - 1) +
         AdaptiveIntegral(f, halves[1], values[1], share, depth - 1);
}

/// The integral of f(Vec3f) over the sphere.
template <typename Function>
double IntegrateSphere(const Function& f, double tolerance = 1e-5) {
  constexpr int kRings = 8, kSectors = 8;
  constexpr double kTurn = 2 * std::numbers::pi;
  double sum = 0;
  for (const bool upper : {false, true}) {
    for (int i = 0; i < kRings; ++i) {
      for (int j = 0; j < kSectors; ++j) {
        const SphereCell cell = {upper, double(i) / kRings, double(i + 1) / kRings,
                                 kTurn * j / kSectors, kTurn * (j + 1) / kSectors};
        sum +=
            AdaptiveIntegral(f, cell, GaussIntegral(f, cell), tolerance / (2 * kRings * kSectors));
      }
    }
  }
  return sum;
}

}  // namespace strata
