#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "common/report.h"
#include "common/status.h"

// How two images of the same pixels differ, and whether the difference is more than their noise
// (Jung, Hanika, Dachsbacher 2020, "Detecting Bias in Monte Carlo Renderers using Welch's t-test",
// Journal of Computer Graphics Techniques 9(2)). Colour channels are tested one by one: the files
// carry no covariances, without which a luminance has no known error.

namespace strata {

/// Each of the three tests calls this share of equal images different, or less.
inline constexpr double kDifferenceLevel = 0.001;
/// Edge in pixels of the tiles whose means are compared; those at the right and the bottom may be
/// smaller.
inline constexpr int kDifferenceTile = 16;
/// Standard errors that a bias must have for a two-sided test at level 0.001 to find it with
/// probability 0.95: the normal quantiles at 0.9995 and 0.95 together. The verdict, which allows
/// for three channels, finds a bias of this size in a single one with probability 0.91.
inline constexpr double kDetectableErrors = 4.94;

/// Degrees of freedom below which few pixels rule a tile's noise. Noise of single pixels is far
/// from normal, and small p-values are then rarer than they should be. The test of uniformity would
/// take that for a difference, so it leaves such tiles out; the test of the smallest p-value, which
/// errs to the safe side with them, does not.
inline constexpr double kUniformityDegrees = 100;

/// Of one channel, or of all three together; means over the pixels compared. B is the reference.
struct DifferenceMetrics {
  double mse = 0;           ///< (A - B)^2
  double relative_mse = 0;  ///< (A - B)^2 / (B^2 + 0.01)
  double mrse = 0;          ///< (A - B)^2 / (|B| + 0.01)^2, as pbrt-v4's imgtool has it
  double bias = 0;          ///< A - B
};

/// What the standard errors say of one channel.
struct ChannelTest {
  double claimed_mse = 0;     ///< Mean of both squared standard errors: what `mse` should be.
  double standard_error = 0;  ///< Of the bias.
  double tile_error = 0;      ///< Median standard error of the difference of two tile means.
  double bias_p = 1;          ///< Welch's test of the means over all pixels.
  double uniformity_p = 1;    ///< Kolmogorov-Smirnov test of the tiles' p-values.
};

/// Three questions to two images that carry standard errors. The p-values are corrected for all
/// that was asked: where the images are equal, each is below x with probability x at most.
struct AgreementTests {
  std::array<ChannelTest, 3> channels;
  double bias_p = 1;        ///< Do the means over all pixels agree? Bonferroni over the channels.
  double uniformity_p = 1;  ///< Are the tiles' p-values uniform? Bonferroni over the channels.
  double smallest_p = 1;    ///< Does every tile agree? Sidak over tiles and channels.

  size_t tests = 0;               ///< Tiles times channels that were tested,
  size_t uniformity_tests = 0;    ///< of them in the test of uniformity: see kUniformityDegrees.
  double smallest_raw_p = 1;      ///< Of them, before correction,
  PixelRect smallest_tile;        ///< where, counted from the first pixel compared,
  int smallest_channel = 0;       ///< and in which channel: 0, 1, 2 is R, G, B.
  size_t constant_equal = 0;      ///< Not tested: no noise and no difference.
  size_t constant_different = 0;  ///< A difference without noise: disagreement, `smallest_p` is 0.
  size_t uneven_tiles = 0;        ///< Tiles whose counts of samples differ by more than half.
};

enum class Verdict {
  kIdentical,  ///< Every pixel compared is equal.
  kAgree,      ///< No test found a difference.
  kDisagree,
  kNotTested,  ///< No standard errors, no pixels, or shared randomness and nothing found.
};
std::string_view ToString(Verdict verdict);  ///< "identical", "agree", "disagree", "not tested".

struct ImageDifference {
  int width = 0, height = 0;
  size_t pixels = 0;  ///< Compared; 0 leaves all figures at 0.
  /// Not compared: a value is NaN or infinite, or the flags of one image say that a sample was.
  size_t excluded = 0;
  DifferenceMetrics all;
  std::array<DifferenceMetrics, 3> channels;
  bool has_errors = false;  ///< Both carry standard errors; `tests` is meaningful.
  /// The headers name the same seed, frame and sampler: noise is the same in both, so differences
  /// are smaller than the tests expect. What they find is there; what they miss may be too.
  bool shared_randomness = false;
  AgreementTests tests;
  Verdict verdict = Verdict::kNotTested;
};

/// The header's value of that name; empty when there is none.
std::string MetadataValue(const ImageLayers& image, std::string_view name);

/// Compares the channels R, G and B, pixel by pixel from the top left. INVALID_ARGUMENT, naming the
/// images by `a_name` and `b_name`, when sizes differ or a channel is missing.
absl::StatusOr<ImageDifference> CompareImages(const ImageLayers& a, const std::string& a_name,
                                              const ImageLayers& b, const std::string& b_name);

}  // namespace strata
