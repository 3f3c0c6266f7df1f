#pragma once

namespace strata {

/// Independent randomizations of a pixel's sequence; every pixel has the same number of samples
/// in each (design: replicates). The spread of their means is what a standard error is made of.
inline constexpr int kReplicates = 8;

/// How the doubles of one pixel lie in memory, in partials and in the film alike:
/// replicate means [kReplicates][estimated], m2 [estimated], m3 [estimated], plain means [plain].
/// m2 and m3 are sums of the second and third powers of deviations from the mean of all samples.
struct PixelLayout {
  int estimated = 3;  ///< Channels that carry an error: R, G, B.
  int plain = 0;      ///< Channels of which the mean alone is kept: alpha, albedo, normal, depth.

  int Doubles() const { return estimated * (kReplicates + 2) + plain; }
  int Mean(int replicate, int channel) const { return replicate * estimated + channel; }
  int M2(int channel) const { return kReplicates * estimated + channel; }
  int M3(int channel) const { return (kReplicates + 1) * estimated + channel; }
  int Plain(int channel) const { return (kReplicates + 2) * estimated + channel; }

  bool operator==(const PixelLayout&) const = default;
};

}  // namespace strata
