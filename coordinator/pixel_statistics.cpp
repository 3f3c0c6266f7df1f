#include "coordinator/pixel_statistics.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "coordinator/pixel_merge.h"

namespace strata {
namespace {

/// Row y of the crop, counted from its first.
void GatherRow(const Film& film, int y, PixelStatistics& statistics) {
  const PixelRect& crop = film.geometry().grid.crop;
  const PixelLayout& layout = film.geometry().layout;
  size_t i = static_cast<size_t>(y) * statistics.size.width;
  for (int x = crop.x0; x < crop.x1; ++x, ++i) {
    const FilmPixel pixel = film.At(x, crop.y0 + y);
    const double n = static_cast<double>(kReplicates) * pixel.counts->samples;
    double mean[kColours];
    for (int c = 0; c < kColours; ++c) {
      mean[c] = PooledMean(layout, pixel.values, c);
      statistics.variance[c][i] = n * ErrorSquared(layout, pixel.values, c, mean[c]);
    }
    statistics.samples[i] = pixel.counts->samples;
    statistics.luminance[i] = Luminance(mean);
    statistics.rays[i] = static_cast<double>(pixel.counts->rays) / n;
    statistics.nonfinite[i] = pixel.counts->nonfinite > 0;
  }
}

}  // namespace

PixelStatistics GatherPixelStatistics(const Film& film) {
  const PixelRect& crop = film.geometry().grid.crop;
  PixelStatistics statistics;
  statistics.size = {static_cast<size_t>(crop.Width()), static_cast<size_t>(crop.Height())};
  const size_t pixels = statistics.size.Pixels();
  statistics.samples.resize(pixels);
  statistics.luminance.resize(pixels);
  for (Plane& plane : statistics.variance) plane.resize(pixels);
  statistics.rays.resize(pixels);
  statistics.nonfinite.resize(pixels);

  std::atomic<int> next_row = 0;
  const auto work = [&] {
    for (int y; (y = next_row.fetch_add(1)) < crop.Height();) GatherRow(film, y, statistics);
  };
  const int threads =
      std::min(static_cast<int>(std::thread::hardware_concurrency()), crop.Height());
  std::vector<std::jthread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back(work);
  work();
  helpers.clear();  // Joins.
  return statistics;
}

}  // namespace strata
