#include "coordinator/pixel_statistics.h"

#include "coordinator/pixel_merge.h"

namespace strata {

PixelStatistics GatherPixelStatistics(const Film& film) {
  const PixelRect& crop = film.geometry().grid.crop;
  const PixelLayout& layout = film.geometry().layout;
  PixelStatistics statistics;
  statistics.size = {static_cast<size_t>(crop.Width()), static_cast<size_t>(crop.Height())};
  const size_t pixels = statistics.size.Pixels();
  statistics.samples.resize(pixels);
  statistics.luminance.resize(pixels);
  for (std::vector<double>& plane : statistics.variance) plane.resize(pixels);
  statistics.rays.resize(pixels);
  statistics.nonfinite.resize(pixels);
  size_t i = 0;
  for (int y = crop.y0; y < crop.y1; ++y) {
    for (int x = crop.x0; x < crop.x1; ++x, ++i) {
      const FilmPixel pixel = film.At(x, y);
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
  return statistics;
}

}  // namespace strata
