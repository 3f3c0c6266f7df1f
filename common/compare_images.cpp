#include "common/compare_images.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "common/pixel_layout.h"
#include "common/statistics.h"

namespace strata {
namespace {

constexpr size_t kColours = 3;
constexpr const char* kColourNames[kColours] = {"R", "G", "B"};
constexpr double kPixelDegrees = kReplicates - 1;

/// The channels of an image that matter here.
class ImageView {
 public:
  static absl::StatusOr<ImageView> Of(const ImageLayers& image, const std::string& name) {
    ImageView view(image);
    for (size_t c = 0; c < kColours; ++c) {
      view.colour_[c] = view.Find(kColourNames[c]);
      view.error_[c] = view.Find(absl::StrCat("stderr.", kColourNames[c]));
      if (view.colour_[c] == kNone) {
        return absl::InvalidArgumentError(absl::StrCat(
            name, ": there is no channel ", kColourNames[c], ", give an image with R, G and B"));
      }
    }
    view.samples_ = view.Find("samples.Y");
    view.flags_ = view.Find("flags.Y");
    return view;
  }

  bool has_errors() const { return std::find(error_.begin(), error_.end(), kNone) == error_.end(); }
  bool has_samples() const { return samples_ != kNone; }
  double Colour(size_t pixel, size_t c) const { return Value(pixel, colour_[c]); }
  double Variance(size_t pixel, size_t c) const {
    const double error = Value(pixel, error_[c]);
    return error * error;
  }
  double Samples(size_t pixel) const { return Value(pixel, samples_); }

  /// Whether the pixel's values are finite and come of finite samples.
  bool Usable(size_t pixel) const {
    if (flags_ != kNone) {
      const double flags = Value(pixel, flags_);
      if (!(flags >= 0 && flags <= std::numeric_limits<uint32_t>::max())) return false;
      if (static_cast<uint32_t>(flags) & kFlagNonFinite) return false;
    }
    for (size_t c = 0; c < kColours; ++c) {
      if (!std::isfinite(Colour(pixel, c))) return false;
      if (has_errors() && !std::isfinite(Variance(pixel, c))) return false;
    }
    return true;
  }

 private:
  static constexpr size_t kNone = static_cast<size_t>(-1);

  explicit ImageView(const ImageLayers& image) : image_(&image) {}
  size_t Find(const std::string& channel) const {
    const auto& names = image_->channels;
    const auto found = std::find(names.begin(), names.end(), channel);
    return found == names.end() ? kNone : static_cast<size_t>(found - names.begin());
  }
  double Value(size_t pixel, size_t channel) const {
    return image_->values[pixel * image_->channels.size() + channel];
  }

  const ImageLayers* image_;
  std::array<size_t, kColours> colour_{}, error_{};
  size_t samples_ = kNone, flags_ = kNone;
};

struct ImagePair {
  ImageView a, b;
  bool has_errors = false, has_samples = false;
};

/// Sums over pixels of one channel.
struct ChannelSums {
  double difference = 0, magnitude = 0, squared = 0, relative = 0, mrse = 0;
  VarianceSum variance;

  void AddColours(double a, double b) {
    const double d = a - b, floored = std::fabs(b) + 0.01;
    difference += d;
    magnitude += std::fabs(a) + std::fabs(b);
    squared += d * d;
    relative += d * d / (b * b + 0.01);
    mrse += d * d / (floored * floored);
  }
  void Add(const ChannelSums& other) {
    difference += other.difference;
    magnitude += other.magnitude;
    squared += other.squared;
    relative += other.relative;
    mrse += other.mrse;
    variance.Add(other.variance);
  }
};

struct Sums {
  std::array<ChannelSums, kColours> channels;
  double a_samples = 0, b_samples = 0;
  size_t pixels = 0, excluded = 0;

  void Add(const Sums& other) {
    for (size_t c = 0; c < kColours; ++c) channels[c].Add(other.channels[c]);
    a_samples += other.a_samples;
    b_samples += other.b_samples;
    pixels += other.pixels;
    excluded += other.excluded;
  }
};

Sums SumTile(const ImagePair& images, const PixelRect& tile, int width) {
  Sums sums;
  for (int y = tile.y0; y < tile.y1; ++y) {
    for (int x = tile.x0; x < tile.x1; ++x) {
      const size_t pixel =
          static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x);
      if (!images.a.Usable(pixel) || !images.b.Usable(pixel)) {
        ++sums.excluded;
        continue;
      }
      ++sums.pixels;
      if (images.has_samples) {
        sums.a_samples += images.a.Samples(pixel);
        sums.b_samples += images.b.Samples(pixel);
      }
      for (size_t c = 0; c < kColours; ++c) {
        sums.channels[c].AddColours(images.a.Colour(pixel, c), images.b.Colour(pixel, c));
        if (!images.has_errors) continue;
        sums.channels[c].variance.Add(images.a.Variance(pixel, c));
        sums.channels[c].variance.Add(images.b.Variance(pixel, c));
      }
    }
  }
  return sums;
}

/// What two means of the same pixels say of each other.
struct MeanTest {
  enum class Kind { kNoisy, kConstantEqual, kConstantDifferent };
  Kind kind = Kind::kNoisy;
  double standard_error = 0;
  double degrees = 0, p = 1;  ///< Of kNoisy.
};

MeanTest TestMeans(const ChannelSums& sums, size_t pixels) {
  // A float carries 2^-24 of its value. Where noise is below 16 times that, rounding decides, and
  // means are equal to within 8 such errors.
  constexpr double kNoNoise = 0x1p-20, kEqual = 0x1p-17;
  const auto n = static_cast<double>(pixels);
  const double difference = std::fabs(sums.difference) / n, level = sums.magnitude / (2 * n);
  MeanTest test;
  test.standard_error = std::sqrt(sums.variance.sum) / n;
  if (test.standard_error <= kNoNoise * level) {
    test.kind = difference <= kEqual * level ? MeanTest::Kind::kConstantEqual
                                             : MeanTest::Kind::kConstantDifferent;
    return test;
  }
  test.degrees = sums.variance.Degrees(kPixelDegrees);
  test.p = StudentTwoSidedP(difference / test.standard_error, test.degrees);
  return test;
}

/// The tiles of one channel: p-values for the test of uniformity, all standard errors.
struct TileFigures {
  std::vector<double> p, standard_errors;
};

/// Collects the tests of tiles, then closes them with those of the whole image.
class Agreement {
 public:
  void AddTile(const Sums& sums, const PixelRect& tile) {
    if (sums.pixels == 0) return;
    constexpr double kUneven = 1.5;  // More than adaptive allocation differs between two seeds.
    const auto [fewer, more] = std::minmax(sums.a_samples, sums.b_samples);
    if (more > kUneven * fewer) ++tests_.uneven_tiles;
    for (size_t c = 0; c < kColours; ++c) {
      const MeanTest test = TestMeans(sums.channels[c], sums.pixels);
      tiles_[c].standard_errors.push_back(test.standard_error);
      switch (test.kind) {
        case MeanTest::Kind::kConstantEqual:
          ++tests_.constant_equal;
          break;
        case MeanTest::Kind::kConstantDifferent:
          ++tests_.constant_different;
          break;
        case MeanTest::Kind::kNoisy:
          AddTest(test, tile, c);
      }
    }
  }

  AgreementTests Finish(const Sums& image) {
    const auto n = static_cast<double>(image.pixels);
    for (size_t c = 0; c < kColours; ++c) {
      ChannelTest& channel = tests_.channels[c];
      const MeanTest mean = TestMeans(image.channels[c], image.pixels);
      channel.claimed_mse = image.channels[c].variance.sum / n;
      channel.standard_error = mean.standard_error;
      channel.bias_p = mean.kind == MeanTest::Kind::kConstantDifferent ? 0 : mean.p;
      channel.tile_error = Median(tiles_[c].standard_errors);
      tests_.uniformity_tests += tiles_[c].p.size();
      channel.uniformity_p = KolmogorovSmirnovP(std::move(tiles_[c].p));
      tests_.bias_p = std::min(tests_.bias_p, kColours * channel.bias_p);
      tests_.uniformity_p = std::min(tests_.uniformity_p, kColours * channel.uniformity_p);
    }
    tests_.smallest_p =
        tests_.constant_different > 0 ? 0 : SidakP(tests_.smallest_raw_p, tests_.tests);
    return tests_;
  }

 private:
  void AddTest(const MeanTest& test, const PixelRect& tile, size_t channel) {
    ++tests_.tests;
    if (test.degrees >= kUniformityDegrees) tiles_[channel].p.push_back(test.p);
    if (test.p >= tests_.smallest_raw_p) return;
    tests_.smallest_raw_p = test.p;
    tests_.smallest_tile = tile;
    tests_.smallest_channel = static_cast<int>(channel);
  }

  static double Median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return values.empty() ? 0 : *middle;
  }

  AgreementTests tests_;
  std::array<TileFigures, kColours> tiles_;
};

std::vector<PixelRect> Tiles(int width, int height) {
  std::vector<PixelRect> tiles;
  for (int y = 0; y < height; y += kDifferenceTile) {
    for (int x = 0; x < width; x += kDifferenceTile) {
      tiles.push_back(
          {x, y, std::min(x + kDifferenceTile, width), std::min(y + kDifferenceTile, height)});
    }
  }
  return tiles;
}

DifferenceMetrics Metrics(const ChannelSums& sums, size_t pixels) {
  const auto n = static_cast<double>(pixels);
  return {sums.squared / n, sums.relative / n, sums.mrse / n, sums.difference / n};
}

bool SharedRandomness(const ImageLayers& a, const ImageLayers& b) {
  const auto same = [&](const char* name) {
    const std::string value = MetadataValue(a, name);
    return !value.empty() && value == MetadataValue(b, name);
  };
  // The bare Halton sequence is the same for all seeds.
  const bool plain_halton =
      MetadataValue(a, "sampler") == ToString(SamplerKind::kHaltonPlain) && same("sampler");
  return plain_halton || (same("seed") && same("frame") && same("sampler"));
}

Verdict Judge(const ImageDifference& difference) {
  const AgreementTests& tests = difference.tests;
  if (difference.pixels == 0) return Verdict::kNotTested;
  if (difference.all.mse == 0) return Verdict::kIdentical;
  if (!difference.has_errors) return Verdict::kNotTested;
  // Noise that is the same in both makes differences small and p-values large, so that they are
  // not uniform; a small one still means what it says.
  const bool differ = tests.bias_p < kDifferenceLevel || tests.smallest_p < kDifferenceLevel ||
                      (!difference.shared_randomness && tests.uniformity_p < kDifferenceLevel);
  if (differ) return Verdict::kDisagree;
  return difference.shared_randomness ? Verdict::kNotTested : Verdict::kAgree;
}

}  // namespace

std::string_view ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kIdentical:
      return "identical";
    case Verdict::kAgree:
      return "agree";
    case Verdict::kDisagree:
      return "disagree";
    case Verdict::kNotTested:
      break;
  }
  return "not tested";
}

std::string MetadataValue(const ImageLayers& image, std::string_view name) {
  for (const auto& [key, value] : image.metadata) {
    if (key == name) return value;
  }
  return "";
}

absl::StatusOr<ImageDifference> CompareImages(const ImageLayers& a, const std::string& a_name,
                                              const ImageLayers& b, const std::string& b_name) {
  const int width = a.crop.Width(), height = a.crop.Height();
  if (width != b.crop.Width() || height != b.crop.Height()) {
    return absl::InvalidArgumentError(
        absl::StrCat(b_name, ": ", b.crop.Width(), " x ", b.crop.Height(), " pixels, but ", a_name,
                     " has ", width, " x ", height, "; compare images of one size"));
  }
  STRATA_ASSIGN_OR_RETURN(const ImageView a_view, ImageView::Of(a, a_name));
  STRATA_ASSIGN_OR_RETURN(const ImageView b_view, ImageView::Of(b, b_name));
  const ImagePair images = {a_view, b_view, a_view.has_errors() && b_view.has_errors(),
                            a_view.has_samples() && b_view.has_samples()};
  Sums image;
  Agreement agreement;
  for (const PixelRect& tile : Tiles(width, height)) {
    const Sums sums = SumTile(images, tile, width);
    if (images.has_errors) agreement.AddTile(sums, tile);
    image.Add(sums);
  }

  ImageDifference result;
  result.width = width;
  result.height = height;
  result.pixels = image.pixels;
  result.excluded = image.excluded;
  result.has_errors = images.has_errors && image.pixels > 0;
  result.shared_randomness = SharedRandomness(a, b);
  if (image.pixels > 0) {
    ChannelSums all;
    for (size_t c = 0; c < kColours; ++c) {
      result.channels[c] = Metrics(image.channels[c], image.pixels);
      all.Add(image.channels[c]);
    }
    result.all = Metrics(all, kColours * image.pixels);
  }
  if (result.has_errors) result.tests = agreement.Finish(image);
  result.verdict = Judge(result);
  return result;
}

}  // namespace strata
