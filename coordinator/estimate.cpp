#include "coordinator/estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/pixel_merge.h"

namespace strata {
namespace {

constexpr int kMargin = EstimateInput::kMargin;
constexpr size_t kReach = kMargin;

/// The square of s_R / sqrt(R) over replicate means.
double ErrorSquared(const PixelLayout& layout, const double* values, int channel, double mean) {
  double sum = 0;
  for (int r = 0; r < kReplicates; ++r) {
    const double deviation = values[layout.Mean(r, channel)] - mean;
    sum += deviation * deviation;
  }
  return sum / ((kReplicates - 1) * kReplicates);
}

/// Sums over square neighbourhoods of the wanted pixels. The order of additions is the same for
/// every pixel of an image, wherever it lies in its rectangle.
class Neighbourhoods {
 public:
  explicit Neighbourhoods(const PixelRect& wanted)
      : width_(static_cast<size_t>(wanted.Width())),
        height_(static_cast<size_t>(wanted.Height())) {}

  /// Over the 3x3 block, the pixel included.
  std::vector<double> Block(const std::vector<double>& plane) const { return Sum<1, true>(plane); }
  /// Over the 5x5 ring, the pixel itself left out, so that its own samples have no influence.
  std::vector<double> Ring(const std::vector<double>& plane) const {
    return Sum<kReach, false>(plane);
  }

 private:
  // Sums of rows first, then of columns of these sums; the pixel's own row comes last, so that
  // leaving the pixel out needs no subtraction.
  template <size_t kRadius, bool kWithCentre>
  std::vector<double> Sum(const std::vector<double>& plane) const {
    const size_t rows = height_ + 2 * kRadius;
    std::vector<double> row_sums(rows * width_);
    for (size_t j = 0; j < rows; ++j) {
      AddRow<kRadius, true>(&plane[RowStart(j + kReach - kRadius)], &row_sums[j * width_]);
    }
    std::vector<double> sums(height_ * width_);
    for (size_t y = 0; y < height_; ++y) {
      double* sum = &sums[y * width_];
      for (size_t j = 0; j <= 2 * kRadius; ++j) {
        if (j == kRadius) continue;
        const double* row = &row_sums[(y + j) * width_];
        for (size_t x = 0; x < width_; ++x) sum[x] += row[x];
      }
      AddRow<kRadius, kWithCentre>(&plane[RowStart(y + kReach)], sum);
    }
    return sums;
  }

  /// Where a row of the plane begins, counted from the margin's first one.
  size_t RowStart(size_t row) const { return row * (width_ + 2 * kReach); }

  template <size_t kRadius, bool kWithCentre>
  void AddRow(const double* row, double* sums) const {
    for (size_t x = 0; x < width_; ++x) {
      double sum = 0;
      for (size_t k = kReach - kRadius; k <= kReach + kRadius; ++k) {
        if (kWithCentre || k != kReach) sum += row[x + k];
      }
      sums[x] += sum;
    }
  }

  size_t width_, height_;
};

}  // namespace

EstimateInput GatherEstimateInput(const Film& film, const PixelRect& wanted) {
  const PixelRect& crop = film.geometry().grid.crop;
  const PixelLayout& layout = film.geometry().layout;
  const size_t stride = static_cast<size_t>(wanted.Width()) + 2 * kReach;
  const size_t pixels = stride * (static_cast<size_t>(wanted.Height()) + 2 * kReach);
  EstimateInput input;
  input.wanted = wanted;
  input.samples.resize(pixels);
  input.nonfinite.resize(pixels);
  for (auto* planes : {&input.mean, &input.error_squared, &input.m2, &input.m3}) {
    for (std::vector<double>& plane : *planes) plane.resize(pixels);
  }
  const int x0 = std::max(wanted.x0 - kMargin, crop.x0),
            x1 = std::min(wanted.x1 + kMargin, crop.x1);
  const int y0 = std::max(wanted.y0 - kMargin, crop.y0),
            y1 = std::min(wanted.y1 + kMargin, crop.y1);
  for (int y = y0; y < y1; ++y) {
    size_t k = static_cast<size_t>(y - (wanted.y0 - kMargin)) * stride +
               static_cast<size_t>(x0 - (wanted.x0 - kMargin));
    for (int x = x0; x < x1; ++x, ++k) {
      const FilmPixel pixel = film.At(x, y);
      input.samples[k] = static_cast<double>(kReplicates) * pixel.counts->samples;
      input.nonfinite[k] = pixel.counts->nonfinite > 0;
      for (int c = 0; c < kColours; ++c) {
        input.mean[c][k] = PooledMean(layout, pixel.values, c);
        input.error_squared[c][k] = ErrorSquared(layout, pixel.values, c, input.mean[c][k]);
        input.m2[c][k] = pixel.values[layout.M2(c)];
        input.m3[c][k] = pixel.values[layout.M3(c)];
      }
    }
  }
  return input;
}

std::vector<PixelEstimate> Estimate(const EstimateInput& input) {
  const Neighbourhoods around(input.wanted);
  const size_t pixels = static_cast<size_t>(input.wanted.Pixels());
  std::vector<PixelEstimate> estimates(pixels);

  std::vector<double> has_samples(input.samples.size());
  std::transform(input.samples.begin(), input.samples.end(), has_samples.begin(),
                 [](double n) { return n > 0 ? 1.0 : 0.0; });
  const std::vector<double> block_pixels = around.Block(has_samples);
  const std::vector<double> ring_samples = around.Ring(input.samples);

  const size_t width = static_cast<size_t>(input.wanted.Width());
  const auto input_index = [width](size_t i) {
    return (i / width + kReach) * (width + 2 * kReach) + i % width + kReach;
  };
  for (int c = 0; c < kColours; ++c) {
    // n times the squared error: what one sample contributes, comparable between pixels whose
    // counts differ.
    std::vector<double> scaled(input.samples.size());
    for (size_t k = 0; k < scaled.size(); ++k) {
      scaled[k] = input.samples[k] * input.error_squared[c][k];
    }
    const std::vector<double> block_scaled = around.Block(scaled);
    const std::vector<double> ring_m2 = around.Ring(input.m2[c]);
    const std::vector<double> ring_m3 = around.Ring(input.m3[c]);
    for (size_t i = 0; i < pixels; ++i) {
      const size_t k = input_index(i);
      const double n = input.samples[k];
      if (n == 0) continue;
      PixelEstimate& estimate = estimates[i];
      estimate.mean[c] = input.mean[c][k];
      estimate.standard_error[c] = std::sqrt(input.error_squared[c][k]);
      estimate.variance[c] = input.m2[c][k] / (n - 1);
      estimate.ci95[c] = kStudent50 * std::sqrt(block_scaled[i] / block_pixels[i] / n);
      // N < 25 g^2 with g^2 = (sum m3)^2 (sum n) / (sum m2)^3, free of the division.
      const double skewness = 25 * ring_m3[i] * ring_m3[i] * ring_samples[i];
      if (n * ring_m2[i] * ring_m2[i] * ring_m2[i] < skewness) estimate.flags |= kFlagSkew;
    }
  }
  for (size_t i = 0; i < pixels; ++i) {
    const size_t k = input_index(i);
    estimates[i].samples = static_cast<uint64_t>(input.samples[k]);
    if (!input.nonfinite[k]) continue;
    estimates[i].flags |= kFlagNonFinite;
    std::fill_n(estimates[i].ci95, kColours, std::numeric_limits<double>::infinity());
  }
  return estimates;
}

}  // namespace strata
