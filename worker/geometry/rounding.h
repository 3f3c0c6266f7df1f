#pragma once

#include "worker/math/vec.h"

namespace strata {

/// Half a unit in the last place of 1 in float: the relative error of one rounding.
inline constexpr float kRoundoff = 0x1p-24f;

/// Bound of the relative error of n roundings in a row (PBRT 6.8.1).
constexpr float Gamma(int n) { return n * kRoundoff / (1 - n * kRoundoff); }

}  // namespace strata
