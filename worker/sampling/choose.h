#pragma once

#include <cstddef>

namespace strata {

/// The largest float below 1, where a quotient of random numbers may round up to it.
inline constexpr float kBelowOne = 0x1.fffffep-1f;

/// One of a few outcomes, in proportion to weight(0) to weight(count - 1), of which one must be
/// positive, by a number in [0, their sum): `*left`, of which what is over comes back, at most the
/// outcome's weight but for rounding. What rounding leaves goes to the last that has a weight.
template <typename Real, typename Weight>
size_t ChooseByWeight(size_t count, const Weight& weight, Real* left) {
  size_t chosen = 0;
  Real rest = *left;
  for (size_t i = 0; i < count; ++i) {
    const Real w = weight(i);
    if (!(w > 0)) continue;
    chosen = i;
    *left = rest;
    if (rest < w) break;
    rest -= w;
  }
  return chosen;
}

}  // namespace strata
