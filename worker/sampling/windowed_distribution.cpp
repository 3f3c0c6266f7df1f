#include "worker/sampling/windowed_distribution.h"

#include <algorithm>
#include <cmath>

namespace strata {
namespace {

/// Where in [low, high], in cells, the increasing function `f`, linear within each cell, is
/// `target`.
template <typename F>
double Invert(const F& f, double low, double high, double target) {
  int first = static_cast<int>(std::floor(low)), last = static_cast<int>(std::ceil(high)) - 1;
  while (first < last) {
    const int middle = first + (last - first) / 2;
    if (f(middle + 1) <= target)
      first = middle + 1;
    else
      last = middle;
  }
  const double left = std::max<double>(first, low), right = std::min<double>(first + 1, high);
  const double at_left = f(left), at_right = f(right);
  const double part = at_right > at_left ? (target - at_left) / (at_right - at_left) : 0.5;
  return left + std::clamp(part, 0.0, 1.0) * (right - left);
}

/// As a coordinate of the unit square, below the window's end.
float ToSquare(double cells, int count, float low, float high) {
  const float x = static_cast<float>(cells / count);
  return std::clamp(x, low, std::max(low, std::nextafter(high, 0.0f)));
}

}  // namespace

WindowedDistribution::WindowedDistribution(std::span<const float> weights, int width, int height)
    : width_(width),
      height_(height),
      sums_((static_cast<size_t>(width) + 1) * (static_cast<size_t>(height) + 1), 0.0) {
  const auto fill = [&](auto weight) {
    for (int y = 0; y < height; ++y) {
      double row = 0;
      for (int x = 0; x < width; ++x) {
        row += weight(static_cast<size_t>(y) * width + x);
        const size_t at = static_cast<size_t>(y + 1) * (width + 1) + x + 1;
        sums_[at] = sums_[at - width - 1] + row;
      }
    }
  };
  fill([&](size_t i) {
    return weights[i] > 0 && std::isfinite(weights[i]) ? double{weights[i]} : 0.0;
  });
  if (!(sums_.back() > 0)) fill([](size_t) { return 1.0; });
}

double WindowedDistribution::Integral(double x, double y) const {
  const int ix = std::clamp(static_cast<int>(x), 0, width_ - 1);
  const int iy = std::clamp(static_cast<int>(y), 0, height_ - 1);
  const double fx = x - ix, fy = y - iy;
  return (1 - fy) * ((1 - fx) * Corner(ix, iy) + fx * Corner(ix + 1, iy)) +
         fy * ((1 - fx) * Corner(ix, iy + 1) + fx * Corner(ix + 1, iy + 1));
}

double WindowedDistribution::Mass(const Window& window) const {
  const double x0 = double{window.low.x} * width_, x1 = double{window.high.x} * width_;
  const double y0 = double{window.low.y} * height_, y1 = double{window.high.y} * height_;
  return Integral(x1, y1) - Integral(x0, y1) - Integral(x1, y0) + Integral(x0, y0);
}

double WindowedDistribution::Weight(Vec2f point) const {
  const int x = std::clamp(static_cast<int>(point.x * static_cast<float>(width_)), 0, width_ - 1);
  const int y = std::clamp(static_cast<int>(point.y * static_cast<float>(height_)), 0, height_ - 1);
  return Corner(x + 1, y + 1) - Corner(x, y + 1) - Corner(x + 1, y) + Corner(x, y);
}

Vec2f WindowedDistribution::Sample(const Window& window, Vec2f u, float* pdf) const {
  *pdf = 0;
  const double x0 = double{window.low.x} * width_, x1 = double{window.high.x} * width_;
  const double y0 = double{window.low.y} * height_, y1 = double{window.high.y} * height_;
  if (!(x1 > x0 && y1 > y0)) return window.low;
  // The window's columns, then a cell of the column.
  const auto columns = [&](double x) { return Integral(x, y1) - Integral(x, y0); };
  const double left = columns(x0), right = columns(x1);
  if (!(right > left)) return window.low;
  const double x = Invert(columns, x0, x1, left + u.x * (right - left));
  const double column = std::min(std::floor(x), width_ - 1.0);
  const auto cells = [&](double y) { return Integral(column + 1, y) - Integral(column, y); };
  const double bottom = cells(y0), top = cells(y1);
  const double y = Invert(cells, y0, y1, bottom + u.y * (top - bottom));
  const Vec2f point = {ToSquare(x, width_, window.low.x, window.high.x),
                       ToSquare(y, height_, window.low.y, window.high.y)};
  *pdf = Pdf(window, point);
  return point;
}

float WindowedDistribution::Pdf(const Window& window, Vec2f point) const {
  if (!window.Contains(point)) return 0;
  const double mass = Mass(window);
  const double cells = static_cast<double>(width_) * height_;
  return mass > 0 ? static_cast<float>(Weight(point) * cells / mass) : 0;
}

}  // namespace strata
