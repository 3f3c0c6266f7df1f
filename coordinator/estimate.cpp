#include "coordinator/estimate.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/pixel_merge.h"
#include "coordinator/ring_pool.h"

namespace strata {
namespace {

constexpr int kMargin = EstimateInput::kMargin;
constexpr size_t kReach = kMargin;
static_assert(kReach == Neighbourhoods::kReach);

}  // namespace

double ErrorSquared(const PixelLayout& layout, const double* values, int channel, double mean) {
  double sum = 0;
  for (int r = 0; r < kReplicates; ++r) {
    const double deviation = values[layout.Mean(r, channel)] - mean;
    sum += deviation * deviation;
  }
  return sum / ((kReplicates - 1) * kReplicates);
}

EstimateInput GatherEstimateInput(const Film& film, const PixelRect& wanted, SamplerKind sampler) {
  const PixelRect& crop = film.geometry().grid.crop;
  const PixelLayout& layout = film.geometry().layout;
  const size_t stride = static_cast<size_t>(wanted.Width()) + 2 * kReach;
  const size_t pixels = stride * (static_cast<size_t>(wanted.Height()) + 2 * kReach);
  EstimateInput input;
  input.wanted = wanted;
  input.claims_interval = ClaimsInterval(sampler);
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
  const size_t width = static_cast<size_t>(input.wanted.Width());
  const size_t pixels = static_cast<size_t>(input.wanted.Pixels());
  const Neighbourhoods around({width, pixels / width});
  std::vector<PixelEstimate> estimates(pixels);

  std::vector<double> has_samples(input.samples.size());
  std::transform(input.samples.begin(), input.samples.end(), has_samples.begin(),
                 [](double n) { return n > 0 ? 1.0 : 0.0; });
  const std::vector<double> neighbours = around.Beside(has_samples);
  const std::vector<double> ring_samples = around.Ring(input.samples);

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
    const std::vector<double> beside = around.Beside(scaled);
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
      const bool alone = neighbours[i] == 0;
      const double v = alone ? scaled[k] : 0.5 * (scaled[k] + beside[i] / neighbours[i]);
      estimate.ci95[c] = (alone ? kStudent7 : kStudent25) * std::sqrt(v / n);
      // g^2 = (sum m3)^2 (sum n) / (sum m2)^3, free of the division.
      const double most = kMostSkewness * kMostSkewness * n;
      if (ring_m3[i] * ring_m3[i] * ring_samples[i] > most * ring_m2[i] * ring_m2[i] * ring_m2[i])
        estimate.flags |= kFlagSkew;
    }
  }
  for (size_t i = 0; i < pixels; ++i) {
    const size_t k = input_index(i);
    estimates[i].samples = static_cast<uint64_t>(input.samples[k]);
    if (input.nonfinite[k]) estimates[i].flags |= kFlagNonFinite;
    if (!input.claims_interval) estimates[i].flags |= kFlagNoInterval;
    if (input.claims_interval && !input.nonfinite[k]) continue;
    std::fill_n(estimates[i].ci95, kColours, std::numeric_limits<double>::infinity());
  }
  return estimates;
}

}  // namespace strata
