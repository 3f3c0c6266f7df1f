#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "absl/strings/str_cat.h"
#include "common/unit.h"
#include "coordinator/estimate.h"
#include "coordinator/pixel_merge.h"
#include "tests/stability/picture.h"
#include "worker/integrator/pixel_sum.h"
#include "worker/sampling/hash.h"

// The sums of one pixel over a thousand million samples: the worker's for each piece and the
// coordinator's over the pieces, cut as a job of that length is cut.

namespace strata {
namespace {

constexpr uint32_t kPerReplicate = kMaxSpp / kReplicates;
constexpr double kSamples = kMaxSpp;

/// Sample `index` of a replicate, for a channel.
using SampleFunction = std::function<float(int replicate, uint32_t index, int channel)>;

const PixelLayout kLayout;
using Values = std::array<double, (kReplicates + 2) * 3>;

Values SumOf(const SampleRange& piece, const SampleFunction& sample) {
  PixelSum sum(kLayout);
  Values values{};
  bool finite = true;
  for (int r = 0; r < kReplicates; ++r) {
    for (uint32_t i = piece.begin; i < piece.end; ++i)
      finite &= sum.Add({{sample(r, i, 0), sample(r, i, 1), sample(r, i, 2)}, {}});
    sum.FinishReplicate(r, values.data());
  }
  sum.Finish(values.data());
  EXPECT_TRUE(finite);
  return values;
}

/// What the film holds after all of kMaxSpp samples. If the samples repeat within a piece, all
/// pieces of a length have equal sums, and each need be summed once.
Values MergedPixel(const SampleFunction& sample, bool repeats) {
  Values merged{}, piece_sum{};
  uint32_t summed = 0;  ///< The length that piece_sum is of.
  for (const SampleRange& piece : CutPieces({0, kPerReplicate})) {
    if (!repeats || summed != piece.Count()) piece_sum = SumOf(piece, sample);
    summed = piece.Count();
    MergePixel(kLayout, piece.begin, merged.data(), piece.Count(), piece_sum.data());
  }
  return merged;
}

/// Means, m2, m3 and the squared standard error, in long double and two passes: the mean first.
struct Truth {
  std::array<long double, kReplicates> means{};
  long double mean = 0, m2 = 0, m3 = 0, error_squared = 0;
};

Truth TruthOf(const SampleFunction& sample, int channel, uint32_t samples) {
  Truth truth;
  for (int r = 0; r < kReplicates; ++r) {
    for (uint32_t i = 0; i < samples; ++i) truth.means[r] += sample(r, i, channel);
    truth.means[r] /= samples;
    truth.mean += truth.means[r] / kReplicates;
  }
  for (int r = 0; r < kReplicates; ++r) {
    const long double of_replicate = truth.means[r] - truth.mean;
    truth.error_squared += of_replicate * of_replicate / (kReplicates * (kReplicates - 1));
    for (uint32_t i = 0; i < samples; ++i) {
      const long double d = sample(r, i, channel) - truth.mean;
      truth.m2 += d * d;
      truth.m3 += d * d * d;
    }
  }
  const long double repeated = static_cast<long double>(kPerReplicate) / samples;
  truth.m2 *= repeated;
  truth.m3 *= repeated;
  return truth;
}

struct Errors {
  double mean = 0, m2 = 0, m3 = 0, standard_error = 0;
};

/// Relative, but that of m3 to sd^3 n, since it may vanish.
Errors ErrorsOf(const std::string& name, const Values& merged, const Truth& truth, int channel) {
  Errors errors;
  for (int r = 0; r < kReplicates; ++r) {
    const long double error = merged[kLayout.Mean(r, channel)] / truth.means[r] - 1;
    errors.mean = std::max(errors.mean, static_cast<double>(std::fabs(error)));
  }
  errors.m2 = std::fabs(static_cast<double>(merged[kLayout.M2(channel)] / truth.m2 - 1));
  const long double third = truth.m2 * std::sqrt(truth.m2 / kMaxSpp);
  errors.m3 = std::fabs(static_cast<double>((merged[kLayout.M3(channel)] - truth.m3) / third));
  const double mean = PooledMean(kLayout, merged.data(), channel);
  const double error_squared = ErrorSquared(kLayout, merged.data(), channel, mean);
  errors.standard_error =
      std::fabs(static_cast<double>(std::sqrt(error_squared / truth.error_squared) - 1));
  Report(name + ", relative error of the replicate means", errors.mean);
  Report(name + ", of m2", errors.m2);
  Report(name + ", of m3 over n sd^3", errors.m3);
  Report(name + ", of the standard error", errors.standard_error);
  return errors;
}

constexpr uint32_t kPeriod = 1 << 10;

/// Three pixels that floats hold exactly. Replicates differ a little, so that there is a standard
/// error to be found.
/// 0: mean/sd of a million, the least steps that float has there.
/// 1: dark but for one sample in 512 that is a thousand million times as bright.
/// 2: 1e-30 and 1e30 in turn.
float EdgeSample(int replicate, uint32_t index, int channel) {
  const uint32_t k = (index * 387 + 17 * static_cast<uint32_t>(replicate)) % kPeriod;
  const bool other = k < 4 * static_cast<uint32_t>(replicate);
  if (channel == 0) return 0x1p22f + static_cast<float>(k % 13) + static_cast<float>(other);
  if (channel == 1) return k % 512 == 3 ? 1e9f : other ? 1.5f : 1;
  return k % 2 != 0 || other ? 1e30f : 1e-30f;
}

TEST(BillionSamples, KeepMeansMomentsAndErrors) {
  const Values merged = MergedPixel(EdgeSample, true);
  const std::array<const char*, 3> names = {"mean/sd 1e6", "rare bright samples", "1e-30 and 1e30"};
  for (int channel = 0; channel < 3; ++channel) {
    const Truth truth = TruthOf(EdgeSample, channel, kPeriod);
    if (channel == 0)
      Report("mean/sd", static_cast<double>(truth.mean / std::sqrt(truth.m2 / kSamples)));
    const Errors errors = ErrorsOf(names[channel], merged, truth, channel);
    // A mean is updated 2^19 times in a piece, each time rounded by up to 2^-53 of it, which adds
    // up at random or, where samples repeat, in one direction: at worst to 6e-11, and to some 1e-13
    // in fact. The standard error of a billion samples with mean/sd 1e6 is 3e-11 of the mean: 1e-12
    // is a thirtieth of it. Of m2 it moves each term by mean/sd times as much, at random signs.
    EXPECT_LE(errors.mean, 1e-12) << names[channel];
    EXPECT_LE(errors.m2, 1e-8) << names[channel];
    EXPECT_LE(errors.m3, 1e-9) << names[channel];
    EXPECT_LE(errors.standard_error, 1e-4) << names[channel];
  }
}

TEST(BillionSamples, SumsOfPowersInDoubleAreTheControlThatFails) {
  // The sums of one piece, n times: kinder than adding up all samples.
  const uint32_t count = 1 << 19;
  double sum = 0, squares = 0;
  for (int r = 0; r < kReplicates; ++r) {
    for (uint32_t i = 0; i < count; ++i) {
      const double x = EdgeSample(r, i, 0);
      sum += x;
      squares += x * x;
    }
  }
  const double times = static_cast<double>(kPerReplicate) / count;
  const double m2 = (squares - sum * sum / (kReplicates * double{count})) * times;
  const double error = std::fabs(static_cast<double>(m2 / TruthOf(EdgeSample, 0, kPeriod).m2 - 1));
  Report("sums of squares, relative error of m2", error);
  EXPECT_GT(error, 1e-8);
}

/// Uniform in (1, 1.0001) on all 24 bits of a float there: mean/sd 3e4, no sample like another.
float DistinctSample(int replicate, uint32_t index, int channel) {
  const uint64_t bits =
      MixBits(index + (uint64_t{static_cast<uint32_t>(8 * channel + replicate)} << 32));
  return 1 + 1e-4f * static_cast<float>(bits >> 40) * 0x1p-24f;
}

/// Two minutes long: by hand, with --gtest_also_run_disabled_tests.
TEST(BillionSamples, DISABLED_AllDistinct) {
  const Values merged = MergedPixel(DistinctSample, false);
  const Errors errors =
      ErrorsOf("distinct samples", merged, TruthOf(DistinctSample, 1, kPerReplicate), 1);
  EXPECT_LE(errors.mean, 1e-12);
  EXPECT_LE(errors.m2, 1e-8);
  EXPECT_LE(errors.m3, 1e-8);
  // The spread of the replicates is 3e-9 of their mean.
  EXPECT_LE(errors.standard_error, 1e-3);
}

}  // namespace
}  // namespace strata
