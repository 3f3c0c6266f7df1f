#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "common/moments.h"
#include "common/pixel_layout.h"
#include "worker/math/vec.h"

namespace strata {

/// One sample of one pixel, weighted by the filter.
struct PixelValue {
  static constexpr int kMaxPlain = 8;  ///< Alpha, albedo, normal, depth.
  Rgb color;
  std::array<float, kMaxPlain> plain{};  ///< In the order of PlainChannelNames.
};

/// What the samples of one pixel in one unit come to, in the order they are added: replicate by
/// replicate, each in the order of its sequence (design, section 3).
class PixelSum {
 public:
  explicit PixelSum(const PixelLayout& layout) : layout_(layout) {}

  /// False when a value is NaN or infinite; the sample then counts as zero.
  bool Add(const PixelValue& value) {
    bool finite = IsFinite(value.color);
    for (int i = 0; i < layout_.plain; ++i) finite = finite && std::isfinite(value.plain[i]);
    const Rgb color = finite ? value.color : Rgb{};
    const Channels x = {color.r, color.g, color.b, 0};
    ++in_replicate_;
    all_.Add(x);
    replicate_mean_ += (x - replicate_mean_) / static_cast<double>(in_replicate_);
    const double total = static_cast<double>(all_.count);
    for (int i = 0; i < layout_.plain; ++i)
      plain_mean_[i] += ((finite ? value.plain[i] : 0) - plain_mean_[i]) / total;
    return finite;
  }

  /// Writes the mean of the samples since the last call to the pixel's doubles.
  void FinishReplicate(int replicate, double* values) {
    for (int c = 0; c < 3; ++c) values[layout_.Mean(replicate, c)] = replicate_mean_[c];
    replicate_mean_ = Channels{};
    in_replicate_ = 0;
  }

  /// Writes all that concerns the replicates together.
  void Finish(double* values) const {
    for (int c = 0; c < 3; ++c) {
      values[layout_.M2(c)] = all_.m2[c];
      values[layout_.M3(c)] = all_.m3[c];
    }
    for (int i = 0; i < layout_.plain; ++i) values[layout_.Plain(i)] = plain_mean_[i];
  }

 private:
  using Channels __attribute__((vector_size(32))) = double;  ///< Three, and a zero.

  PixelLayout layout_;
  BasicMoments<Channels> all_;
  Channels replicate_mean_ = {};
  uint64_t in_replicate_ = 0;
  std::array<double, PixelValue::kMaxPlain> plain_mean_{};
};

}  // namespace strata
