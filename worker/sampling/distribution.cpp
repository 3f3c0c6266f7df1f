#include "worker/sampling/distribution.h"

#include <bit>
#include <cmath>

namespace strata {
namespace {

constexpr uint32_t kPoints = 1u << 24;

double Clean(double weight) { return weight > 0 && std::isfinite(weight) ? weight : 0; }

/// Shares the points among the cells: one to each cell of positive weight, the others in proportion
/// by rounding the running sum. Writes weights.size() + 1 starts.
template <typename Weight>
void ShareOut(std::span<const Weight> weights, uint32_t* starts) {
  double total = 0;
  uint32_t positive = 0;
  for (const Weight weight : weights) {
    total += Clean(weight);
    positive += Clean(weight) > 0;
  }
  const bool uniform = !(total > 0) || !std::isfinite(total);
  if (uniform) positive = static_cast<uint32_t>(weights.size());
  const double scale =
      static_cast<double>(kPoints - positive) / (uniform ? static_cast<double>(positive) : total);
  double sum = 0;
  uint32_t passed = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    starts[i] = passed + static_cast<uint32_t>(std::floor(sum * scale + 0.5));
    const double weight = uniform ? 1 : Clean(weights[i]);
    sum += weight;
    passed += weight > 0;
    // After the last positive cell no rounding may be left over.
    if (passed == positive) sum = uniform ? static_cast<double>(positive) : total;
  }
  starts[weights.size()] = kPoints;
}

int CellOf(float x, int cells) { return static_cast<int>(x * static_cast<float>(cells)); }

/// Inverts the shares of `cells` cells.
PiecewiseConstant1D::Point Invert(const uint32_t* starts, int cells, float u) {
  const uint32_t point = std::min(static_cast<uint32_t>(u * 0x1p24f), kPoints - 1);
  const int cell = static_cast<int>(std::upper_bound(starts, starts + cells, point) - starts) - 1;
  const float count = static_cast<float>(starts[cell + 1] - starts[cell]);
  const float fraction = (static_cast<float>(point - starts[cell]) + 0.5f) / count;
  // Rounding must not move the point to a neighbour, whose density is another.
  float x = (static_cast<float>(cell) + fraction) / static_cast<float>(cells);
  while (CellOf(x, cells) > cell) x = std::bit_cast<float>(std::bit_cast<uint32_t>(x) - 1);
  while (CellOf(x, cells) < cell) x = std::bit_cast<float>(std::bit_cast<uint32_t>(x) + 1);
  return {x, cell, std::min(fraction, 1 - 0x1p-24f), count * 0x1p-24f};
}

std::vector<double> RowSums(std::span<const float> weights, int width, int height) {
  std::vector<double> sums(height, 0.0);
  for (int y = 0; y < height; ++y) {
    for (const float weight : weights.subspan(static_cast<size_t>(y) * width, width)) {
      sums[y] += Clean(weight);
    }
  }
  return sums;
}

}  // namespace

PiecewiseConstant1D::PiecewiseConstant1D(std::span<const double> weights)
    : starts_(weights.size() + 1) {
  ShareOut(weights, starts_.data());
}

PiecewiseConstant1D::Point PiecewiseConstant1D::Sample(float u) const {
  return Invert(starts_.data(), cells(), u);
}

PiecewiseConstant2D::PiecewiseConstant2D(std::span<const float> weights, int width, int height)
    : rows_(RowSums(weights, width, height)),
      width_(width),
      starts_(static_cast<size_t>(width + 1) * height) {
  for (int y = 0; y < height; ++y) {
    ShareOut(weights.subspan(static_cast<size_t>(y) * width, width),
             &starts_[static_cast<size_t>(y) * (width + 1)]);
  }
}

Vec2f PiecewiseConstant2D::Sample(Vec2f u, float* pdf) const {
  const PiecewiseConstant1D::Point row = rows_.Sample(u.y);
  const PiecewiseConstant1D::Point column =
      Invert(&starts_[static_cast<size_t>(row.cell) * (width_ + 1)], width_, u.x);
  *pdf = row.probability * static_cast<float>(rows_.cells()) * column.probability *
         static_cast<float>(width_);
  return {column.x, row.x};
}

float PiecewiseConstant2D::Pdf(Vec2f point) const {
  const int height = rows_.cells();
  const int x = std::clamp(CellOf(point.x, width_), 0, width_ - 1);
  const int y = std::clamp(CellOf(point.y, height), 0, height - 1);
  const uint32_t* start = &starts_[static_cast<size_t>(y) * (width_ + 1) + x];
  return rows_.Probability(y) * static_cast<float>(height) *
         (static_cast<float>(start[1] - start[0]) * 0x1p-24f) * static_cast<float>(width_);
}

}  // namespace strata
