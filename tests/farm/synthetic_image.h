#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "coordinator/pixel_statistics.h"

namespace strata {

/// How a sample of a synthetic pixel is distributed: independent, grey, with known moments.
struct SyntheticPixel {
  double dark = 0;         ///< The value of most samples.
  double bright = 0;       ///< What is added to a share of them.
  double probability = 0;  ///< That share.
  double deviation = 0;    ///< Of normal noise on top.

  double Mean() const { return dark + probability * bright; }
  double Variance() const {
    return deviation * deviation + probability * (1 - probability) * bright * bright;
  }
};

/// An image whose true means and variances are known, rendered by drawing sums of samples.
class SyntheticImage {
 public:
  SyntheticImage(PlaneSize size, const std::function<SyntheticPixel(size_t x, size_t y)>& pixel)
      : size_(size) {
    for (size_t y = 0; y < size.height; ++y) {
      for (size_t x = 0; x < size.width; ++x) pixels_.push_back(pixel(x, y));
    }
  }

  PlaneSize size() const { return size_; }
  const std::vector<SyntheticPixel>& pixels() const { return pixels_; }

 private:
  PlaneSize size_;
  std::vector<SyntheticPixel> pixels_;
};

/// Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators".
class SplitMix {
 public:
  using result_type = uint64_t;
  explicit SplitMix(uint64_t seed) : state_(seed) {}
  static constexpr uint64_t min() { return 0; }
  static constexpr uint64_t max() { return ~uint64_t{0}; }
  uint64_t operator()() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

 private:
  uint64_t state_;
};

/// One render of it, sample by sample in rounds. Each pixel has random numbers of its own.
class SyntheticRender {
 public:
  SyntheticRender(const SyntheticImage& image, uint64_t seed)
      : image_(image), sums_(image.pixels().size() * kReplicates), samples_(image.pixels().size()) {
    SplitMix seeds(seed);
    for (size_t i = 0; i < samples_.size(); ++i) random_.emplace_back(seeds());
  }

  /// Each pixel then has at least ends[i] samples in each replicate.
  void RenderTo(const std::vector<uint32_t>& ends) {
    for (size_t i = 0; i < samples_.size(); ++i) RenderPixelTo(i, ends[i]);
  }
  void RenderTo(uint32_t end) { RenderTo(std::vector<uint32_t>(samples_.size(), end)); }

  void RenderPixelTo(size_t i, uint32_t end) {
    if (end <= samples_[i]) return;
    const uint32_t more = end - samples_[i];
    samples_[i] = end;
    for (int r = 0; r < kReplicates; ++r) sums_[i * kReplicates + r] += Sum(i, more);
  }
  /// The pixel's samples will be others. Requires that it has none yet.
  void Redraw(size_t i, uint64_t seed) { random_[i] = SplitMix(seed); }

  double Mean(size_t i) const {
    double sum = 0;
    for (int r = 0; r < kReplicates; ++r) sum += sums_[i * kReplicates + r];
    return sum / (double{kReplicates} * samples_[i]);
  }
  uint32_t Samples(size_t i) const { return samples_[i]; }
  /// The mean over the pixels, over all replicates.
  double AverageSamples() const {
    double sum = 0;
    for (const uint32_t n : samples_) sum += n;
    return kReplicates * sum / static_cast<double>(samples_.size());
  }

  PixelStatistics Statistics() const {
    const size_t pixels = samples_.size();
    PixelStatistics statistics{image_.size(), samples_};
    statistics.luminance.resize(pixels);
    statistics.rays.assign(pixels, 1);
    statistics.nonfinite.assign(pixels, 0);
    Plane& variance = statistics.variance[0];
    variance.resize(pixels);
    for (size_t i = 0; i < pixels; ++i) {
      const double mean = statistics.luminance[i] = Mean(i);
      double squares = 0;
      for (int r = 0; r < kReplicates; ++r) {
        const double deviation = sums_[i * kReplicates + r] / samples_[i] - mean;
        squares += deviation * deviation;
      }
      variance[i] = samples_[i] * squares / (kReplicates - 1);
    }
    statistics.variance[1] = statistics.variance[2] = variance;
    return statistics;
  }

 private:
  double Sum(size_t i, uint32_t samples) {
    const SyntheticPixel& pixel = image_.pixels()[i];
    double sum = samples * pixel.dark;
    if (pixel.probability > 0) {
      sum += pixel.bright * std::binomial_distribution<int>(static_cast<int>(samples),
                                                            pixel.probability)(random_[i]);
    }
    if (pixel.deviation > 0) {
      sum += pixel.deviation * std::sqrt(samples) * std::normal_distribution<double>()(random_[i]);
    }
    return sum;
  }

  const SyntheticImage& image_;
  std::vector<SplitMix> random_;
  std::vector<double> sums_;  ///< Of each replicate.
  std::vector<uint32_t> samples_;
};

/// Smooth dark parts, a noisy bright disk, and a band of rare bright samples: noise over a factor
/// of 30, as pictures have it.
inline SyntheticImage UnevenImage(size_t edge) {
  return SyntheticImage({edge, edge}, [edge](size_t x, size_t y) {
    const double u = static_cast<double>(x) / static_cast<double>(edge) - 0.3;
    const double v = static_cast<double>(y) / static_cast<double>(edge) - 0.4;
    SyntheticPixel pixel{0.4, 0, 0, 0.05 + 0.05 * u * u};
    if (u * u + v * v < 0.03) pixel.deviation = 0.6;
    if (v > 0.35) {
      pixel.bright = 8;
      pixel.probability = 0.03;
    }
    return pixel;
  });
}

/// Rare bright samples of many heights over noise of many levels.
inline SyntheticImage SkewedImage(size_t edge) {
  return SyntheticImage({edge, edge}, [edge](size_t x, size_t y) {
    const double u = static_cast<double>(x) / static_cast<double>(edge);
    const double v = static_cast<double>(y) / static_cast<double>(edge);
    SyntheticPixel pixel{0.1 + 0.4 * u, 0, 0, 0.05 + 0.3 * u * v};
    if (v > 0.6) pixel.bright = 1 + 4 * u;
    if (v > 0.6) pixel.probability = 0.05;
    return pixel;
  });
}

/// A bright lamp with a noisy rim two to four pixels wide, its glow, and a dark corner with rare
/// light.
inline SyntheticImage LampImage(size_t edge) {
  return SyntheticImage({edge, edge}, [edge](size_t x, size_t y) {
    const double u = static_cast<double>(x) / static_cast<double>(edge) - 0.3;
    const double v = static_cast<double>(y) / static_cast<double>(edge) - 0.4;
    const double r = std::sqrt(u * u + v * v);
    if (r < 0.1) return SyntheticPixel{5, 0, 0, 0.05};
    if (r < 0.12) return SyntheticPixel{1, 4, 0.3, 0.2};
    if (u > 0.5 && v > 0.4) return SyntheticPixel{0.02, 1, 0.02, 0.01};
    return SyntheticPixel{0.3, 0, 0, r < 0.3 ? 0.3 : 0.1};
  });
}

/// One sample in 40 to 300 is 25 times as bright as the others.
inline SyntheticImage RareImage(size_t edge) {
  return SyntheticImage({edge, edge}, [edge](size_t x, size_t) {
    const double u = static_cast<double>(x) / static_cast<double>(edge);
    return SyntheticPixel{0.2, 5, 0.003 + 0.02 * u, 0.05};
  });
}

}  // namespace strata
