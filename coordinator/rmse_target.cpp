#include <algorithm>
#include <cmath>
#include <limits>

#include "coordinator/error_target.h"

namespace strata {
namespace {

/// Steps of the grid of K to the octave.
constexpr int kSteps = 32;
/// Of the mean square, planned below the target, since what the pilot says of it has an error.
constexpr double kMargin = 0.98;

/// K of the grid: 32, 33, ... 63 times powers of two.
double GridValue(int index) {
  const int octave = index >= 0 ? index / kSteps : -((kSteps - 1 - index) / kSteps);
  return std::ldexp(kSteps + index - octave * kSteps, octave);
}

/// The last one of the grid that is not above x. Requires x > 0 and finite.
int GridIndex(double x) {
  int exponent;
  const double mantissa = std::frexp(x, &exponent);  // In [1/2, 1).
  return kSteps * (exponent - 6) + static_cast<int>(std::floor(2 * kSteps * mantissa)) - kSteps;
}

/// What a round with a certain K would give.
class Forecast {
 public:
  Forecast(const PixelStatistics& now, uint32_t spp)
      : now_(now), cap_(spp / kReplicates), own_(now.variance[0]) {
    for (int c = 1; c < kColours; ++c) {
      for (size_t i = 0; i < own_.size(); ++i) own_[i] += now.variance[c][i];
    }
    // Of a replicate; the mean square error is over channels, too.
    for (double& own : own_) own /= kReplicates * kColours;
    inside_ = HighestHalfMeans(now.size, own_);
    share_ = RingMeans(now.size, own_);
    const Plane rays = RingMeans(now.size, now.rays);
    for (size_t i = 0; i < share_.size(); ++i)
      share_[i] = std::sqrt(share_[i] / std::max(rays[i], 1.0));
  }

  const Plane& share() const { return share_; }
  double cap() const { return cap_; }

  /// Samples of each replicate; at least what the pixel has. K = 0: what it has.
  double Samples(size_t i, double k) const {
    const double has = now_.samples[i];
    return std::max(has, std::min(std::ceil(k * share_[i]), cap_));
  }
  /// Of a pixel's mean, averaged over the channels. From its own variance, which is not biased by
  /// how its count was found, as its count is from its ring.
  double SquaredError(size_t i, double k) const { return own_[i] / Samples(i, k); }
  /// The same of a pixel of i's 5x5, if it has i's samples and the variance of that half of i's
  /// ring where it is greatest. The mean over the ring would be too little where a few pixels,
  /// close together, have most of the noise: they would stop first, and the target would never be
  /// met.
  double SquaredErrorInside(size_t i, double k) const { return inside_[i] / Samples(i, k); }

  void Fill(Plane& plane, double k) const {
    plane.resize(own_.size());
    for (size_t i = 0; i < plane.size(); ++i) plane[i] = SquaredError(i, k);
  }
  double MeanSquare(double k) const {
    double sum = 0;
    for (size_t i = 0; i < own_.size(); ++i) sum += SquaredError(i, k);
    return sum / static_cast<double>(own_.size());
  }

 private:
  const PixelStatistics& now_;
  double cap_;
  Plane own_, inside_, share_;
};

/// Indices of the grid: `first` and those before it give no pixel more than it has, `last` gives
/// each the cap.
struct GridRange {
  int first = 0, last = 0;
};

GridRange RangeOf(const PixelStatistics& now, const Forecast& forecast) {
  double largest = 0, smallest = std::numeric_limits<double>::infinity();
  for (const double share : forecast.share()) {
    if (!(share > 0)) continue;
    largest = std::max(largest, share);
    smallest = std::min(smallest, share);
  }
  if (largest == 0) return {};
  const double has = *std::min_element(now.samples.begin(), now.samples.end());
  const int first = GridIndex(has / largest);
  return {first, std::max(first, GridIndex(forecast.cap() / smallest) + 1)};
}

/// The mean square as it is planned for each pixel: of the pixels outside of its 5x5 what they
/// show, of those inside what its ring shows. Calls visit(i, mean).
template <typename Visit>
void VisitMeanSquares(PlaneSize size, const Forecast& forecast, double k, Visit visit) {
  const double pixels = static_cast<double>(size.Pixels());
  Plane plane;
  forecast.Fill(plane, k);
  VisitMeansOutside(size, plane, [&](size_t y, const double* means) {
    for (size_t x = 0, i = y * size.width; x < size.width; ++x, ++i) {
      const double inside = static_cast<double>(PixelsInside(size, x, y)) / pixels;
      visit(i, (1 - inside) * means[x] + inside * forecast.SquaredErrorInside(i, k));
    }
  });
}

/// For each pixel the least index with which its mean square is at most `planned`; the last one if
/// none is; range.first - 1, with which no pixel gets more than it has, if the mean square is at
/// most `wanted` as it stands. Larger K make no term of the sums larger, and sums in the same order
/// are monotone in their terms even when rounded, so each pixel's index is well defined: it depends
/// on its mean square alone, while the order in which indices are tried depends on the whole image.
std::vector<int> LeastIndices(PlaneSize size, const Forecast& forecast, GridRange range,
                              double wanted, double planned) {
  const int none = range.first - 1;
  std::vector<int> fails(size.Pixels(), none), holds(size.Pixels(), range.last);
  VisitMeanSquares(size, forecast, 0, [&](size_t i, double mean_square) {
    if (mean_square <= wanted) holds[i] = none;
  });
  const auto attempt = [&](int index) {
    VisitMeanSquares(size, forecast, GridValue(index), [&](size_t i, double mean_square) {
      if (index <= fails[i] || index >= holds[i]) return;
      (mean_square <= planned ? holds[i] : fails[i]) = index;
    });
  };
  // Most pixels have the index of the image as a whole.
  GridRange whole{none, range.last};
  while (whole.last - whole.first > 1) {
    const int middle = whole.first + (whole.last - whole.first) / 2;
    (forecast.MeanSquare(GridValue(middle)) <= planned ? whole.last : whole.first) = middle;
  }
  attempt(whole.last);
  attempt(whole.last - 1);
  for (size_t i = 0; i < size.Pixels(); ++i) {
    while (holds[i] - fails[i] > 1) attempt(fails[i] + (holds[i] - fails[i]) / 2);
  }
  return holds;
}

}  // namespace

TargetRound PlanForRmse(const PixelStatistics& now, double rmse, uint32_t spp) {
  if (!HasOutside(now.size)) return PlanCap(now, spp);
  const Forecast forecast(now, spp);
  const std::vector<int> indices =
      LeastIndices(now.size, forecast, RangeOf(now, forecast), rmse * rmse, kMargin * rmse * rmse);
  TargetRound round{now.samples};
  double squares = 0, sum = 0, uncertain = 0;
  for (size_t i = 0; i < indices.size(); ++i) {
    const double k = GridValue(indices[i]), samples = forecast.Samples(i, k);
    round.ends[i] = static_cast<uint32_t>(samples);
    round.added += uint64_t{kReplicates} * (round.ends[i] - now.samples[i]);
    if (samples > now.samples[i] && samples < forecast.cap()) uncertain += samples;
    const double squared_error = forecast.SquaredError(i, k);
    sum += squared_error;
    squares += squared_error * squared_error;
  }
  // Of a mean of variances with 7 degrees of freedom each, whose squares are too large by 9/7 on
  // average. K is proportional to it.
  constexpr double kDegrees = kReplicates - 1;
  if (sum > 0) {
    round.square_deviation = std::sqrt(2 / (kDegrees + 2) * squares) / sum;
    round.added_deviation = kReplicates * uncertain * round.square_deviation;
  }
  round.error = std::sqrt(forecast.MeanSquare(0));
  round.met = round.error <= rmse;
  round.met_share = round.met;
  return round;
}

}  // namespace strata
