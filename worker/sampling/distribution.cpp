#include "worker/sampling/distribution.h"

#include <bit>
#include <cmath>

namespace strata {
namespace {

constexpr uint32_t kPoints = PiecewiseConstant1D::kPoints;

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

/// A choice among `cells` cells as a point of [0, 1).
PiecewiseConstant1D::Point PointIn(const PiecewiseConstant1D::Choice& choice, int cells) {
  // Rounding must not move the point to a neighbour, whose density is another.
  float x = (static_cast<float>(choice.cell) + choice.fraction) / static_cast<float>(cells);
  while (CellOf(x, cells) > choice.cell) x = std::bit_cast<float>(std::bit_cast<uint32_t>(x) - 1);
  while (CellOf(x, cells) < choice.cell) x = std::bit_cast<float>(std::bit_cast<uint32_t>(x) + 1);
  return {x, choice};
}

/// The number that leads to x among `cells` cells that begin at `starts`.
float InvertIn(const uint32_t* starts, float x, int cells) {
  const int cell = std::clamp(CellOf(x, cells), 0, cells - 1);
  const float fraction = x * static_cast<float>(cells) - static_cast<float>(cell);
  const float points = static_cast<float>(starts[cell + 1] - starts[cell]);
  return (static_cast<float>(starts[cell]) + fraction * points) * 0x1p-24f;
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
  const uint32_t stretches = std::bit_ceil(static_cast<uint32_t>(weights.size()));
  guide_shift_ = static_cast<uint32_t>(std::countr_zero(kPoints / stretches));
  uint32_t cell = 0;
  for (uint32_t stretch = 0; stretch < stretches; ++stretch) {
    while (starts_[cell + 1] <= stretch << guide_shift_) ++cell;
    guide_.push_back(cell);
  }
}

PiecewiseConstant1D::Point PiecewiseConstant1D::Sample(float u) const {
  return PointIn(Choose(u), cells());
}

float PiecewiseConstant1D::Invert(float x) const { return InvertIn(starts_.data(), x, cells()); }

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
  using Row = PiecewiseConstant1D;
  const Row::Point row = rows_.Sample(u.y);
  const uint32_t* starts = &starts_[static_cast<size_t>(row.choice.cell) * (width_ + 1)];
  const uint32_t point = Row::PointOf(u.x);
  const auto cell = std::upper_bound(starts, starts + width_, point) - starts - 1;
  const Row::Point column =
      PointIn(Row::ChoiceOf(starts, static_cast<uint32_t>(cell), point), width_);
  *pdf = row.choice.probability * static_cast<float>(rows_.cells()) * column.choice.probability *
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

Vec2f PiecewiseConstant2D::Invert(Vec2f point) const {
  const int y = std::clamp(CellOf(point.y, rows_.cells()), 0, rows_.cells() - 1);
  const uint32_t* starts = &starts_[static_cast<size_t>(y) * (width_ + 1)];
  return {InvertIn(starts, point.x, width_), rows_.Invert(point.y)};
}

}  // namespace strata
