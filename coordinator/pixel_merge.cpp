#include "coordinator/pixel_merge.h"

#include <algorithm>

namespace strata {
namespace {

void MergeMoments(const PixelLayout& layout, int channel, double samples_a, double* a,
                  double samples_b, const double* b) {
  const double na = kReplicates * samples_a, nb = kReplicates * samples_b;
  const double delta = PooledMean(layout, b, channel) - PooledMean(layout, a, channel);
  const double delta_n = delta / (na + nb);
  const double m2_a = a[layout.M2(channel)], m2_b = b[layout.M2(channel)];
  a[layout.M3(channel)] += b[layout.M3(channel)] + delta * delta_n * delta_n * na * nb * (na - nb) +
                           3 * delta_n * (na * m2_b - nb * m2_a);
  a[layout.M2(channel)] += m2_b + delta * delta_n * na * nb;
}

}  // namespace

void MergePixel(const PixelLayout& layout, double samples_a, double* a, double samples_b,
                const double* b) {
  if (samples_a == 0) {
    std::copy_n(b, layout.Doubles(), a);
    return;
  }
  for (int c = 0; c < layout.estimated; ++c) MergeMoments(layout, c, samples_a, a, samples_b, b);
  const double weight = samples_b / (samples_a + samples_b);
  const auto merge_mean = [&](int i) { a[i] += (b[i] - a[i]) * weight; };
  for (int i = 0; i < kReplicates * layout.estimated; ++i) merge_mean(i);
  for (int i = 0; i < layout.plain; ++i) merge_mean(layout.Plain(i));
}

}  // namespace strata
