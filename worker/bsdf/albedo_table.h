#pragma once

#include <algorithm>
#include <array>
#include <cmath>

namespace strata {

/// A function of a cosine and of GGX's alpha, both in [0, 1], smooth in their square roots.
class AlbedoTable {
 public:
  AlbedoTable() = default;
  /// Tabulates f(cos_theta, alpha); f is never called with a cosine of 0.
  template <typename Function>
  explicit AlbedoTable(const Function& f) {
    for (int a = 0; a < kAlphas; ++a) {
      const float root_alpha = static_cast<float>(a) / (kAlphas - 1);
      for (int c = 0; c < kCosines; ++c) {
        const float root_cos = std::max(1e-2f, static_cast<float>(c) / (kCosines - 1));
        values_[a][c] = f(root_cos * root_cos, root_alpha * root_alpha);
      }
      mean_[a] = CosineWeightedMean(values_[a]);
    }
  }

  float At(float cos_theta, float alpha) const {
    const Cell a = FindCell(alpha, kAlphas);
    const Cell c = FindCell(cos_theta, kCosines);
    return Lerp(At(a, c.index), At(a, c.index + 1), c.fraction);
  }

  static constexpr int kCosines = 33;
  using Row = std::array<float, kCosines>;
  /// The function of one alpha at the squares of equal steps of the cosine's root, 0 to 1.
  Row RowAt(float alpha) const {
    const Cell a = FindCell(alpha, kAlphas);
    Row row;
    for (int c = 0; c < kCosines; ++c) row[c] = At(a, c);
    return row;
  }

  /// Mean over the hemisphere, weighted by the cosine.
  float Mean(float alpha) const {
    const Cell a = FindCell(alpha, kAlphas);
    return Lerp(mean_[a.index], mean_[a.index + 1], a.fraction);
  }

 private:
  static constexpr int kAlphas = 17;

  /// Where x lies between `count` nodes at the squares of equal steps.
  struct Cell {
    int index;
    float fraction;
  };
  static Cell FindCell(float x, int count) {
    const float scaled = std::sqrt(std::clamp(x, 0.0f, 1.0f)) * static_cast<float>(count - 1);
    const int index = std::min(static_cast<int>(scaled), count - 2);
    return {index, scaled - static_cast<float>(index)};
  }
  static float Lerp(float a, float b, float t) { return a + (b - a) * t; }
  float At(Cell a, int cosine) const {
    return Lerp(values_[a.index][cosine], values_[a.index + 1][cosine], a.fraction);
  }

  /// The integral of the interpolated row f over 4 s^3 ds, s = sqrt(cos).
  static float CosineWeightedMean(const Row& row) {
    constexpr int kSteps = 16 * (kCosines - 1);
    double sum = 0;
    for (int i = 0; i < kSteps; ++i) {
      const double s = (i + 0.5) / kSteps;
      const int cell = i / 16;
      const double f = row[cell] + (row[cell + 1] - row[cell]) * (s * (kCosines - 1) - cell);
      sum += f * 4 * s * s * s;
    }
    return static_cast<float>(sum / kSteps);
  }

  std::array<Row, kAlphas> values_ = {};
  std::array<float, kAlphas> mean_ = {};
};

}  // namespace strata
