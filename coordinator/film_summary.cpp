#include "coordinator/film_summary.h"

#include <algorithm>
#include <cmath>

#include "coordinator/pixel_statistics.h"

namespace strata {
namespace {

constexpr double kRelErrorQuantile = 0.99;
constexpr size_t kWorstTiles = 5;

/// The smallest value that at least a share of all values does not exceed. Reorders them.
double Quantile(std::vector<float>& values, double share) {
  if (values.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto place = values.begin() + std::max<ptrdiff_t>(static_cast<ptrdiff_t>(rank) - 1, 0);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Appends half-width over max(luminance, least) of each channel. A pixel that claims no interval,
/// as a sample was not finite, is left out; it is counted elsewhere.
void AppendRelErrors(const float mean[], const float ci95[], double least_luminance,
                     std::vector<float>& errors) {
  if (!std::isfinite(ci95[0])) return;
  const double rgb[kColours] = {mean[0], mean[1], mean[2]};
  const double scale = 1 / std::max(Luminance(rgb), least_luminance);
  for (int c = 0; c < kColours; ++c) errors.push_back(static_cast<float>(ci95[c] * scale));
}

}  // namespace

SummaryInput::SummaryInput(const TileGrid& grid)
    : grid_(grid), pixels_(static_cast<size_t>(grid.crop.Pixels())) {}

size_t SummaryInput::IndexOf(int x, int y) const {
  const PixelRect& crop = grid_.crop;
  return static_cast<size_t>(y - crop.y0) * static_cast<size_t>(crop.Width()) +
         static_cast<size_t>(x - crop.x0);
}

void SummaryInput::Update(uint32_t tile, const std::vector<PixelEstimate>& estimates) {
  const PixelRect rect = grid_.Rect(tile);
  const PixelEstimate* estimate = estimates.data();
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x, ++estimate) {
      Pixel& pixel = pixels_[IndexOf(x, y)];
      std::copy_n(estimate->mean, kColours, pixel.mean);
      std::copy_n(estimate->ci95, kColours, pixel.ci95);
      pixel.flags = estimate->flags;
      pixel.has_samples = estimate->samples > 0;
    }
  }
}

FilmSummary SummaryInput::Summarize(double widening) const {
  FilmSummary summary;
  uint64_t flagged = 0;
  bool complete = true;
  for (const Pixel& pixel : pixels_) {
    for (int c = 0; c < kColours; ++c) summary.mean_rgb[c] += pixel.mean[c];
    flagged += pixel.flags != 0;
    complete &= pixel.has_samples;
  }
  const double pixels = static_cast<double>(pixels_.size());
  for (double& mean : summary.mean_rgb) mean /= pixels;
  summary.flagged = static_cast<double>(flagged) / pixels;
  const double least_luminance = kLeastShareOfMean * Luminance(summary.mean_rgb);
  // A picture with nothing in it has no relative error.
  if (!complete || !(least_luminance > 0)) return summary;

  std::vector<float> errors;
  errors.reserve(pixels_.size() * kColours);
  for (const Pixel& pixel : pixels_) {
    AppendRelErrors(pixel.mean, pixel.ci95, least_luminance, errors);
  }
  summary.rel_error = widening * Quantile(errors, kRelErrorQuantile);
  summary.worst_tiles = WorstTiles(least_luminance, widening);
  return summary;
}

std::vector<TileError> SummaryInput::WorstTiles(double least_luminance, double widening) const {
  std::vector<TileError> tiles;
  std::vector<float> errors;
  for (uint32_t tile = 0; tile < grid_.Count(); ++tile) {
    const PixelRect rect = grid_.Rect(tile);
    errors.clear();
    for (int y = rect.y0; y < rect.y1; ++y) {
      for (int x = rect.x0; x < rect.x1; ++x) {
        const Pixel& pixel = pixels_[IndexOf(x, y)];
        AppendRelErrors(pixel.mean, pixel.ci95, least_luminance, errors);
      }
    }
    tiles.push_back({rect, widening * Quantile(errors, kRelErrorQuantile)});
  }
  const auto worse = [](const TileError& a, const TileError& b) {
    return a.rel_error > b.rel_error;
  };
  const size_t kept = std::min(kWorstTiles, tiles.size());
  std::partial_sort(tiles.begin(), tiles.begin() + static_cast<ptrdiff_t>(kept), tiles.end(),
                    worse);
  tiles.resize(kept);
  return tiles;
}

}  // namespace strata
