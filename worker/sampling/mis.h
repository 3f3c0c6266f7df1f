#pragma once

#include <algorithm>
#include <cmath>
#include <span>

#include "worker/math/elementary.h"

// Multiple importance sampling over any number of techniques (Veach 1997, chapter 9; PBRT 2.2.3).
// warp.h has the case of two techniques with one sample each, which is the renderer's.
//
// A sample x is judged by its shares, one for each technique: in the multi-sample model (9.2.1)
// n_k p_k(x) with n_k samples of technique k; in the one-sample model (9.2.4) c_k p_k(x), where
// technique k is chosen with probability c_k and one sample is drawn in all. Either way the
// estimate is a sum of MisTerm over the samples drawn, and its expectation is the integral of f,
// provided that some share is positive wherever f is not 0.

namespace strata {

inline constexpr double kBalance = 1;  ///< Exponents of MisWeight.
inline constexpr double kPower = 2;  ///< Veach's choice for techniques of which one is far better.

namespace mis_detail {
/// ratio^beta, the usual exponents without a logarithm.
inline double Raise(double ratio, double beta) {
  if (beta == kBalance) return ratio;
  return beta == kPower ? ratio * ratio : Pow(ratio, beta);
}
}  // namespace mis_detail

/// Weight of a sample that technique `drawn` gave: share^beta over the sum of all shares^beta. The
/// weights of all techniques sum to 1. beta >= 0: 0 is the plain average over techniques, 1 the
/// balance heuristic, 2 the usual power heuristic, infinity the maximum heuristic. Shares that are
/// infinite (delta functions) have the weight among themselves. 0 when the drawn one's share is 0.
inline double MisWeight(std::span<const double> shares, size_t drawn, double beta) {
  const double own = shares[drawn];
  if (!(own > 0)) return 0;
  double sum = 0;
  for (const double share : shares) {
    // Ratios rather than powers: densities may be huge.
    const double ratio = share == own ? 1 : share / own;
    sum += share > 0 ? mis_detail::Raise(ratio, beta) : 0;
  }
  return 1 / sum;
}

/// What the sample adds to the estimate of the integral of f: weight times f over the drawn share.
inline double MisTerm(double f, std::span<const double> shares, size_t drawn, double beta) {
  const double weight = MisWeight(shares, drawn, beta);
  return weight > 0 ? weight * f / shares[drawn] : 0;
}

}  // namespace strata
