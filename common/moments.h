#pragma once

#include <cstdint>

namespace strata {

/// Count, mean and centred moments of a sample: m2 = sum (x-mean)^2, m3 = sum (x-mean)^3.
/// Updates: Welford 1962; Pebay 2008, "Formulas for robust, one-pass parallel computation of
/// covariances and arbitrary-order statistical moments" (third moment). Merging: Chan, Golub and
/// LeVeque 1979; Pebay 2008. The order of Add and Merge decides the bits. Value is double, or a
/// vector of doubles that are counted together.
template <typename Value>
struct BasicMoments {
  uint64_t count = 0;
  Value mean = {}, m2 = {}, m3 = {};

  void Add(Value x) {
    const double n1 = static_cast<double>(count);
    ++count;
    const double n = static_cast<double>(count);
    const Value delta = x - mean;
    const Value delta_n = delta / n;
    const Value term = delta * delta_n * n1;
    m3 += term * delta_n * (n - 2) - 3 * delta_n * m2;
    m2 += term;
    mean += delta_n;
  }

  void Merge(const BasicMoments& other) {
    if (other.count == 0) return;
    if (count == 0) {
      *this = other;
      return;
    }
    const double na = static_cast<double>(count), nb = static_cast<double>(other.count);
    const double n = na + nb;
    const Value delta = other.mean - mean;
    const Value delta_n = delta / n;
    m3 += other.m3 + delta * delta_n * delta_n * na * nb * (na - nb) +
          3 * delta_n * (na * other.m2 - nb * m2);
    m2 += other.m2 + delta * delta_n * na * nb;
    mean += delta_n * nb;
    count += other.count;
  }
};
using Moments = BasicMoments<double>;

}  // namespace strata
