#pragma once

#include <cstddef>

namespace strata {

/// The largest float below 1, where a quotient of random numbers may round up to it.
inline constexpr float kBelowOne = 0x1.fffffep-1f;

/// One of a few outcomes, in proportion to weight(0) to weight(count - 1), by a number in [0, their
/// sum): `*left`, of which what is over comes back, in [0, the outcome's weight). What rounding
/// leaves goes to the last.
template <typename Real, typename Weight>
size_t ChooseByWeight(size_t count, Weight&& weight, Real* left) {
  size_t i = 0;
  for (; i + 1 < count && *left >= weight(i); ++i) *left -= weight(i);
  return i;
}

}  // namespace strata
