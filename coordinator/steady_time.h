#pragma once

#include <chrono>

namespace strata {

/// The farm's time: it never jumps, and enters as an argument.
using SteadyTime = std::chrono::steady_clock::time_point;

inline SteadyTime Now() { return std::chrono::steady_clock::now(); }

/// b - a in seconds.
inline double SecondsBetween(SteadyTime a, SteadyTime b) {
  return std::chrono::duration<double>(b - a).count();
}

}  // namespace strata
