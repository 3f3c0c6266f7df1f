// Comparison of images: figures by hand, and tests of agreement on simulated renders, whose pixels
// are means of eight normal replicates.

#include "common/compare_images.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace strata {
namespace {

ImageLayers Plain(int width, int height, const std::vector<float>& rgb) {
  ImageLayers image;
  image.full_width = width;
  image.full_height = height;
  image.crop = {0, 0, width, height};
  image.channels = {"R", "G", "B"};
  image.values = rgb;
  return image;
}

ImageDifference Compare(const ImageLayers& a, const ImageLayers& b) {
  const absl::StatusOr<ImageDifference> difference = CompareImages(a, "a.exr", b, "b.exr");
  EXPECT_TRUE(difference.ok()) << difference.status();
  return *difference;
}

constexpr size_t kChannels = 8;  ///< R G B stderr.R stderr.G stderr.B samples.Y flags.Y

/// An image of this size with errors, its values set by `pixel(x, y, values)`.
ImageLayers WithErrors(int width, int height,
                       const std::function<void(int x, int y, float* values)>& pixel) {
  ImageLayers image = Plain(width, height, {});
  image.channels = {"R", "G", "B", "stderr.R", "stderr.G", "stderr.B", "samples.Y", "flags.Y"};
  image.values.resize(static_cast<size_t>(width) * height * kChannels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      float* values = &image.values[(static_cast<size_t>(y) * width + x) * kChannels];
      values[6] = 64;
      pixel(x, y, values);
    }
  }
  return image;
}

/// Renders of one picture: pixel (x, y) has noise of standard deviation Sigma(x, y) around 1.
class Renders {
 public:
  explicit Renders(uint64_t seed) : random_(seed) {}

  /// Noise differs thirtyfold between pixels, as in pictures.
  static double Sigma(int x, int y) { return 0.3 / (3 + (7 * x + 13 * y) % 97); }

  /// What is claimed for an error is multiplied by `claim`.
  ImageLayers Next(int width, int height, double claim = 1) {
    return WithErrors(width, height, [&](int x, int y, float* values) {
      for (int c = 0; c < 3; ++c) {
        double sum = 0, squares = 0;
        for (int r = 0; r < 8; ++r) {
          const double replicate = std::sqrt(8) * Sigma(x, y) * normal_(random_);
          sum += replicate;
          squares += replicate * replicate;
        }
        values[c] = static_cast<float>(1 + sum / 8);
        values[3 + c] = static_cast<float>(claim * std::sqrt((squares - sum * sum / 8) / 56));
      }
    });
  }

  /// Standard error of the difference of the means of two such images, in one channel.
  static double StandardError(int width, int height) {
    double sum = 0;
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) sum += 2 * Sigma(x, y) * Sigma(x, y);
    }
    return std::sqrt(sum) / (width * height);
  }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

void AddToChannel(ImageLayers& image, size_t channel, double bias) {
  for (size_t i = channel; i < image.values.size(); i += kChannels) {
    image.values[i] += static_cast<float>(bias);
  }
}

TEST(CompareImages, MetricsFollowTheirDefinitions) {
  const ImageDifference difference =
      Compare(Plain(2, 1, {3, 0, 1, 1, 1, 1}), Plain(2, 1, {1, 0, 1, 1, 0, -1}));
  EXPECT_EQ(difference.pixels, 2u);
  EXPECT_DOUBLE_EQ(difference.channels[0].mse, 2);
  EXPECT_DOUBLE_EQ(difference.channels[0].bias, 1);
  EXPECT_DOUBLE_EQ(difference.channels[0].relative_mse, 4 / 1.01 / 2);
  EXPECT_DOUBLE_EQ(difference.channels[0].mrse, 4 / (1.01 * 1.01) / 2);
  EXPECT_DOUBLE_EQ(difference.channels[1].relative_mse, 50) << "a black reference";
  EXPECT_DOUBLE_EQ(difference.channels[1].mrse, 5000);
  EXPECT_DOUBLE_EQ(difference.channels[2].mrse, 4 / (1.01 * 1.01) / 2) << "a negative reference";
  EXPECT_DOUBLE_EQ(difference.all.mse, (4 + 1 + 4) / 6.0);
  EXPECT_DOUBLE_EQ(difference.all.bias, (2 + 1 + 2) / 6.0);
  EXPECT_FALSE(difference.has_errors);
  EXPECT_EQ(difference.verdict, Verdict::kNotTested);
}

TEST(CompareImages, RefusesWhatCannotBeComparedWithASentence) {
  const ImageLayers image = Plain(2, 1, {1, 1, 1, 1, 1, 1});
  const absl::Status sizes =
      CompareImages(image, "a.exr", Plain(1, 1, {1, 1, 1}), "b.exr").status();
  EXPECT_EQ(sizes.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(sizes.message(),
            "b.exr: 1 x 1 pixels, but a.exr has 2 x 1; compare images of one size");
  ImageLayers grey = image;
  grey.channels = {"R", "G", "Z"};
  const absl::Status channels = CompareImages(image, "a.exr", grey, "b.exr").status();
  EXPECT_EQ(channels.code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(channels.message(), "b.exr: there is no channel B, give an image with R, G and B");
}

TEST(CompareImages, PixelsThatAreNotFiniteAreLeftOutAndCounted) {
  Renders renders(1);
  ImageLayers a = renders.Next(20, 20), b = renders.Next(20, 20);
  a.values[kChannels * 3] = std::numeric_limits<float>::quiet_NaN();
  b.values[kChannels * 50 + 4] = std::numeric_limits<float>::infinity();
  b.values[kChannels * 70] = 1e30f;
  b.values[kChannels * 70 + 7] = kFlagNonFinite | kFlagSkew;
  a.values[kChannels * 80 + 7] = kFlagSkew;  // No reason to leave it out.
  const ImageDifference difference = Compare(a, b);
  EXPECT_EQ(difference.excluded, 3u);
  EXPECT_EQ(difference.pixels, 397u);
  EXPECT_LT(difference.all.mse, 1);
  EXPECT_EQ(difference.verdict, Verdict::kAgree);

  for (float& value : a.values) value = std::numeric_limits<float>::quiet_NaN();
  const ImageDifference none = Compare(a, b);
  EXPECT_EQ(none.pixels, 0u);
  EXPECT_EQ(none.all.mse, 0);
  EXPECT_EQ(none.verdict, Verdict::kNotTested);
}

TEST(CompareImages, TilesReachTheBorders) {
  Renders renders(2);
  ImageLayers a = renders.Next(17, 18);
  const ImageLayers b = renders.Next(17, 18);
  EXPECT_EQ(Compare(a, b).tests.tests, 3u * 4);
  // The last pixel belongs to the tile of two pixels in the corner.
  a.values[kChannels * (17 * 18 - 1) + 2] += 10;
  const ImageDifference difference = Compare(a, b);
  EXPECT_EQ(difference.tests.smallest_tile, (PixelRect{16, 16, 17, 18}));
  EXPECT_EQ(difference.tests.smallest_channel, 2);
  EXPECT_EQ(difference.verdict, Verdict::kDisagree);
}

TEST(CompareImages, TilesWithoutNoiseAreEqualOrDisagree) {
  const auto constant = [](float left) {
    return WithErrors(32, 16, [left](int x, int, float* values) {
      values[0] = x < 16 ? left : 2;
      values[1] = 0;
      values[2] = 5;
    });
  };
  const ImageDifference equal = Compare(constant(1), constant(1 + 0x1p-23f));
  EXPECT_EQ(equal.tests.constant_equal, 6u) << "rounding is no difference";
  EXPECT_EQ(equal.tests.tests, 0u);
  EXPECT_EQ(equal.verdict, Verdict::kAgree);
  const ImageDifference different = Compare(constant(1), constant(1.001f));
  EXPECT_EQ(different.tests.constant_different, 1u);
  EXPECT_EQ(different.tests.smallest_p, 0);
  EXPECT_EQ(different.verdict, Verdict::kDisagree);
}

TEST(CompareImages, EqualImagesAreIdentical) {
  Renders renders(4);
  const ImageLayers image = renders.Next(20, 10);
  EXPECT_EQ(Compare(image, image).verdict, Verdict::kIdentical);
}

/// How many of `pairs` pairs have each p-value below 0.05, and are called different.
struct Rejections {
  int bias = 0, uniformity = 0, smallest = 0, verdict = 0;
};

constexpr int kPairs = 400;

Rejections CountRejections(double claim) {
  Renders renders(5);
  Rejections count;
  for (int pair = 0; pair < kPairs; ++pair) {
    const ImageDifference difference =
        Compare(renders.Next(72, 56, claim), renders.Next(72, 56, claim));
    count.bias += difference.tests.bias_p < 0.05;
    count.uniformity += difference.tests.uniformity_p < 0.05;
    count.smallest += difference.tests.smallest_p < 0.05;
    count.verdict += difference.verdict == Verdict::kDisagree;
  }
  return count;
}

TEST(CompareImages, EqualDistributionsAreCalledDifferentAsOftenAsStated) {
  // 20 of 400 are expected below 0.05, with a standard deviation of 4.4: within four of them. The
  // verdict's level is 0.003 together, 1.2 of 400: more than 8 have probability 1e-5.
  const Rejections count = CountRejections(1);
  EXPECT_NEAR(count.bias, 20, 17.5);
  EXPECT_NEAR(count.uniformity, 20, 17.5);
  EXPECT_NEAR(count.smallest, 20, 17.5);
  EXPECT_LE(count.verdict, 8);
  RecordProperty("verdicts", count.verdict);

  // Control: errors that are claimed a quarter too small.
  const Rejections control = CountRejections(0.75);
  EXPECT_GT(control.bias, 37.5);
  EXPECT_GT(control.uniformity, 37.5);
  EXPECT_GT(control.smallest, 37.5);
  EXPECT_GT(control.verdict, 8);
}

TEST(CompareImages, SkewedNoiseIsNotCalledDifferent) {
  // One sample of 200 is a hundred times brighter: of 8 replicates of 4 samples, most see none.
  std::mt19937_64 random(6);
  std::uniform_real_distribution<double> uniform;
  const auto render = [&] {
    return WithErrors(64, 64, [&](int, int, float* values) {
      double sum = 0, squares = 0;
      for (int r = 0; r < 8; ++r) {
        double replicate = 0;
        for (int i = 0; i < 4; ++i) replicate += uniform(random) + (uniform(random) < 0.005) * 100;
        sum += replicate / 4;
        squares += replicate * replicate / 16;
      }
      for (int c = 0; c < 3; ++c) {
        values[c] = static_cast<float>(sum / 8);
        values[3 + c] = static_cast<float>(std::sqrt((squares - sum * sum / 8) / 56));
      }
    });
  };
  int different = 0;
  for (int pair = 0; pair < 100; ++pair) {
    different += Compare(render(), render()).verdict == Verdict::kDisagree;
  }
  EXPECT_LE(different, 4) << "at 0.003 of 100, more than 4 have probability 2e-5";
}

TEST(CompareImages, FewPixelsThatRuleATileStandAsideFromTheTestOfUniformity) {
  const auto even = [](float level) {
    return WithErrors(32, 16, [level](int, int, float* values) {
      for (int c = 0; c < 3; ++c) values[c] = level, values[3 + c] = 0.1f;
    });
  };
  ImageLayers a = even(1);
  const ImageLayers b = even(1.001f);
  EXPECT_EQ(Compare(a, b).tests.uniformity_tests, 6u);
  a.values[kChannels * 20 + 3] = 1000;  // The error of one channel of a pixel of the right tile.
  const ImageDifference difference = Compare(a, b);
  EXPECT_EQ(difference.tests.tests, 6u);
  EXPECT_EQ(difference.tests.uniformity_tests, 5u);
}

/// How many of 200 pairs differ in the test of means when the red of A is too bright by so many
/// standard errors.
int CountBiasFound(double errors) {
  Renders renders(8);
  const double bias = errors * Renders::StandardError(48, 48);
  int found = 0;
  for (int pair = 0; pair < 200; ++pair) {
    ImageLayers a = renders.Next(48, 48);
    AddToChannel(a, 0, bias);
    found += Compare(a, renders.Next(48, 48)).tests.bias_p < kDifferenceLevel;
  }
  return found;
}

TEST(CompareImages, ABiasOfTheDetectableSizeIsFound) {
  // With probability 0.91 for one of three channels; four standard deviations of 200 are 0.081.
  EXPECT_NEAR(CountBiasFound(kDetectableErrors) / 200.0, 0.912, 0.081);
  // Control: half the size, 0.131.
  EXPECT_NEAR(CountBiasFound(kDetectableErrors / 2) / 200.0, 0.131, 0.096);
}

TEST(CompareImages, TheDetectableBiasIsMadeOfTheStandardErrorOfTheMeans) {
  Renders renders(9);
  const ImageDifference difference = Compare(renders.Next(64, 64), renders.Next(64, 64));
  for (const ChannelTest& channel : difference.tests.channels) {
    const double expected = Renders::StandardError(64, 64);
    EXPECT_NEAR(channel.standard_error / expected, 1, 0.1);
    EXPECT_NEAR(channel.claimed_mse / (expected * expected * 64 * 64), 1, 0.2);
    EXPECT_NEAR(channel.tile_error / Renders::StandardError(16, 16), 1, 0.4);
  }
}

TEST(CompareImages, ErrorsThatCancelOverTheImageAreFoundInItsTiles) {
  // Tiles too bright and too dark by two standard errors in turn: no single one is conspicuous.
  Renders renders(10);
  ImageLayers a = renders.Next(160, 160);
  const ImageLayers b = renders.Next(160, 160);
  EXPECT_GT(Compare(a, b).tests.uniformity_p, kDifferenceLevel);
  const auto bias = static_cast<float>(2 * Renders::StandardError(16, 16));
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 160; ++x) {
      const bool bright = (x / 16 + y / 16) % 2 == 0;
      a.values[kChannels * (static_cast<size_t>(y) * 160 + x)] += bright ? bias : -bias;
    }
  }
  const ImageDifference difference = Compare(a, b);
  EXPECT_GT(difference.tests.bias_p, kDifferenceLevel);
  EXPECT_LT(difference.tests.uniformity_p, kDifferenceLevel);
  EXPECT_EQ(difference.verdict, Verdict::kDisagree);
}

TEST(CompareImages, SharedRandomNumbersProveNoAgreement) {
  Renders renders(11);
  ImageLayers a = renders.Next(48, 48), b = a;
  a.metadata = b.metadata = {{"seed", "3"}, {"frame", "0"}, {"sampler", "sobol"}};
  AddToChannel(b, 1, 0.1 * Renders::StandardError(48, 48));
  const ImageDifference near = Compare(a, b);
  EXPECT_TRUE(near.shared_randomness);
  EXPECT_LT(near.tests.uniformity_p, kDifferenceLevel) << "all p-values are large, not judged";
  EXPECT_EQ(near.verdict, Verdict::kNotTested);
  AddToChannel(b, 1, 10 * Renders::StandardError(48, 48));
  EXPECT_EQ(Compare(a, b).verdict, Verdict::kDisagree) << "what is found all the same is there";
  b.metadata = {{"seed", "4"}, {"frame", "0"}, {"sampler", "sobol"}};
  EXPECT_FALSE(Compare(a, b).shared_randomness);
  a.metadata[2].second = b.metadata[2].second = "halton_plain";
  EXPECT_TRUE(Compare(a, b).shared_randomness) << "the sequence is one for all seeds";
}

TEST(CompareImages, UnevenCountsAreCounted) {
  Renders renders(12);
  ImageLayers a = renders.Next(40, 16);
  const ImageLayers b = renders.Next(40, 16);
  EXPECT_EQ(Compare(a, b).tests.uneven_tiles, 0u);
  for (int y = 0; y < 16; ++y) a.values[kChannels * (static_cast<size_t>(y) * 40 + 39) + 6] = 640;
  EXPECT_EQ(Compare(a, b).tests.uneven_tiles, 1u);
}

}  // namespace
}  // namespace strata
