#pragma once

#include <array>

#include "worker/bsdf/bsdf.h"

namespace strata {

/// What a MixtureBsdf is the sum of.
struct MixtureParts {
  static constexpr int kMax = 4;

  int count = 0;
  std::array<Bsdf, kMax> bsdfs;          ///< None of them a mixture.
  std::array<float, kMax> weights = {};  ///< Positive, of a sum of at most 1.

  void Add(const Bsdf& bsdf, float weight) {
    bsdfs[count] = bsdf;
    weights[count++] = weight;
  }
};

}  // namespace strata
