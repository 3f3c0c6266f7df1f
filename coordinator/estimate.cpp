#include "coordinator/estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/pixel_merge.h"

namespace strata {
namespace {

constexpr int kReach = 2;  ///< Of the largest neighbourhood, the 5x5 ring.

/// The square of s_R / sqrt(R) over replicate means.
double ErrorSquared(const PixelLayout& layout, const double* values, int channel, double mean) {
  double sum = 0;
  for (int r = 0; r < kReplicates; ++r) {
    const double deviation = values[layout.Mean(r, channel)] - mean;
    sum += deviation * deviation;
  }
  return sum / ((kReplicates - 1) * kReplicates);
}

/// A plane of numbers over `covered`, zero outside.
struct Plane {
  const PixelRect& covered;
  const double* values;

  double At(int x, int y) const {
    if (x < covered.x0 || x >= covered.x1 || y < covered.y0 || y >= covered.y1) return 0;
    return values[static_cast<size_t>(y - covered.y0) * covered.Width() + (x - covered.x0)];
  }
};

/// Sums over square neighbourhoods of the wanted pixels. The order of additions is the same for
/// every pixel of an image, wherever it lies in its rectangle.
class Neighbourhoods {
 public:
  Neighbourhoods(const PixelRect& wanted, const PixelRect& covered)
      : wanted_(wanted), covered_(covered) {}

  /// Over the 3x3 block, the pixel included.
  std::vector<double> Block(const std::vector<double>& plane) const {
    return Sum<1, true>({covered_, plane.data()});
  }
  /// Over the 5x5 ring, the pixel itself left out, so that its own samples have no influence.
  std::vector<double> Ring(const std::vector<double>& plane) const {
    return Sum<kReach, false>({covered_, plane.data()});
  }

 private:
  template <int kRadius, bool kWithCentre>
  std::vector<double> Sum(const Plane& plane) const {
    // Sums of rows first, then of columns of these sums; the pixel's own row comes last, so that
    // leaving the pixel out needs no subtraction.
    const int rows = wanted_.Height() + 2 * kRadius, width = wanted_.Width();
    std::vector<double> row_sums(static_cast<size_t>(rows) * width);
    for (int j = 0; j < rows; ++j) {
      for (int i = 0; i < width; ++i) {
        row_sums[static_cast<size_t>(j) * width + i] =
            RowSum<kRadius, true>(plane, wanted_.x0 + i, wanted_.y0 + j - kRadius);
      }
    }
    std::vector<double> sums;
    sums.reserve(static_cast<size_t>(wanted_.Pixels()));
    for (int y = 0; y < wanted_.Height(); ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0;
        for (int j = 0; j <= 2 * kRadius; ++j) {
          if (j != kRadius) sum += row_sums[static_cast<size_t>(y + j) * width + x];
        }
        sums.push_back(sum + RowSum<kRadius, kWithCentre>(plane, wanted_.x0 + x, wanted_.y0 + y));
      }
    }
    return sums;
  }

  template <int kRadius, bool kWithCentre>
  static double RowSum(const Plane& plane, int x, int y) {
    double sum = 0;
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      if (kWithCentre || dx != 0) sum += plane.At(x + dx, y);
    }
    return sum;
  }

  const PixelRect& wanted_;
  const PixelRect& covered_;
};

}  // namespace

EstimateInput GatherEstimateInput(const Film& film, const PixelRect& wanted) {
  const PixelRect& crop = film.geometry().grid.crop;
  const PixelLayout& layout = film.geometry().layout;
  EstimateInput input;
  input.wanted = wanted;
  input.covered = {std::max(wanted.x0 - kReach, crop.x0), std::max(wanted.y0 - kReach, crop.y0),
                   std::min(wanted.x1 + kReach, crop.x1), std::min(wanted.y1 + kReach, crop.y1)};
  const size_t pixels = static_cast<size_t>(input.covered.Pixels());
  input.samples.reserve(pixels);
  input.nonfinite.reserve(pixels);
  for (auto* planes : {&input.mean, &input.error_squared, &input.m2, &input.m3}) {
    for (std::vector<double>& plane : *planes) plane.reserve(pixels);
  }
  for (int y = input.covered.y0; y < input.covered.y1; ++y) {
    for (int x = input.covered.x0; x < input.covered.x1; ++x) {
      const PixelCounts& counts = film.Counts(x, y);
      const double* values = film.Values(x, y);
      input.samples.push_back(static_cast<double>(kReplicates) * counts.samples);
      input.nonfinite.push_back(counts.nonfinite > 0);
      for (int c = 0; c < kColours; ++c) {
        const double mean = PooledMean(layout, values, c);
        input.mean[c].push_back(mean);
        input.error_squared[c].push_back(ErrorSquared(layout, values, c, mean));
        input.m2[c].push_back(values[layout.M2(c)]);
        input.m3[c].push_back(values[layout.M3(c)]);
      }
    }
  }
  return input;
}

std::vector<PixelEstimate> Estimate(const EstimateInput& input) {
  const Neighbourhoods around(input.wanted, input.covered);
  const size_t pixels = static_cast<size_t>(input.wanted.Pixels());
  std::vector<PixelEstimate> estimates(pixels);

  std::vector<double> has_samples(input.samples.size());
  std::transform(input.samples.begin(), input.samples.end(), has_samples.begin(),
                 [](double n) { return n > 0 ? 1.0 : 0.0; });
  const std::vector<double> block_pixels = around.Block(has_samples);
  const std::vector<double> ring_samples = around.Ring(input.samples);

  const auto covered_index = [&](size_t i) {
    const size_t x = i % static_cast<size_t>(input.wanted.Width());
    const size_t y = i / static_cast<size_t>(input.wanted.Width());
    return (y + static_cast<size_t>(input.wanted.y0 - input.covered.y0)) *
               static_cast<size_t>(input.covered.Width()) +
           x + static_cast<size_t>(input.wanted.x0 - input.covered.x0);
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
      const size_t k = covered_index(i);
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
    const size_t k = covered_index(i);
    estimates[i].samples = static_cast<uint64_t>(input.samples[k]);
    if (!input.nonfinite[k]) continue;
    estimates[i].flags |= kFlagNonFinite;
    std::fill_n(estimates[i].ci95, kColours, std::numeric_limits<double>::infinity());
  }
  return estimates;
}

}  // namespace strata
