#include "cli/diff_report.h"

#include <absl/strings/str_format.h>

#include "cli/format.h"
#include "cli/json.h"
#include "common/text.h"

namespace strata {
namespace {

constexpr const char* kColourNames[3] = {"R", "G", "B"};

std::string Number(double value) { return absl::StrFormat("%.3g", value); }

/// "a.exr: 192 x 192 pixels, 64 samples per pixel, seed 1"; of headers that say less, less.
std::string ImageLine(const DiffImage& image) {
  std::string line = absl::StrCat(image.path, ": ", image.layers.crop.Width(), " x ",
                                  image.layers.crop.Height(), " pixels");
  const std::string spp = MetadataValue(image.layers, "spp");
  const std::string seed = MetadataValue(image.layers, "seed");
  if (!spp.empty()) absl::StrAppend(&line, ", ", spp, " samples per pixel");
  if (!seed.empty()) absl::StrAppend(&line, ", seed ", seed);
  return Printable(line);
}

/// A row: `name`, the three channels, and the cell of all.
template <typename Cell>
void AddRow(Table& table, const std::string& name, const std::string& all, Cell cell) {
  table.Add({name, cell(0), cell(1), cell(2), all});
}

std::vector<std::string> MetricLines(const ImageDifference& difference) {
  Table table({{"ERROR OF A"}, {"R", true}, {"G", true}, {"B", true}, {"RGB", true}});
  const auto add_metric = [&](const char* name, double DifferenceMetrics::*metric) {
    AddRow(table, name, Number(difference.all.*metric),
           [&](size_t c) { return Number(difference.channels[c].*metric); });
  };
  const auto add_error = [&](const char* name, double factor, double ChannelTest::*error) {
    AddRow(table, name, "",
           [&](size_t c) { return Number(factor * difference.tests.channels[c].*error); });
  };
  add_metric("MSE", &DifferenceMetrics::mse);
  if (difference.has_errors) add_error("MSE claimed by both", 1, &ChannelTest::claimed_mse);
  add_metric("relMSE", &DifferenceMetrics::relative_mse);
  add_metric("MRSE", &DifferenceMetrics::mrse);
  add_metric("bias, A - B", &DifferenceMetrics::bias);
  if (difference.has_errors) {
    add_error("its standard error", 1, &ChannelTest::standard_error);
    add_error("detectable bias", kDetectableErrors, &ChannelTest::standard_error);
    add_error("detectable in a tile", kDetectableErrors, &ChannelTest::tile_error);
  }
  return table.Lines();
}

std::string TileText(const PixelRect& tile) {
  return absl::StrFormat("pixels %d,%d to %d,%d", tile.x0, tile.y0, tile.x1, tile.y1);
}

/// What the smallest p-value is of.
std::string SmallestText(const AgreementTests& tests) {
  if (tests.constant_different > 0) {
    return absl::StrFormat("%d means of tiles without noise differ", tests.constant_different);
  }
  if (tests.tests == 0) return "no tile has noise";
  return absl::StrFormat("%.3g of %d (Sidak), %s of %s", tests.smallest_raw_p, tests.tests,
                         kColourNames[tests.smallest_channel], TileText(tests.smallest_tile));
}

std::vector<std::string> TestLines(const ImageDifference& difference) {
  const AgreementTests& tests = difference.tests;
  Table table({{"TEST"}, {"P", true}, {"OF WHAT"}});
  table.Add({"image means", Number(tests.bias_p), "Welch's test, 3 channels"});
  table.Add(
      {"tile p-values", Number(tests.uniformity_p),
       absl::StrFormat("uniformity of %d of %d (Kolmogorov-Smirnov)%s", tests.uniformity_tests,
                       tests.tests, difference.shared_randomness ? ", not judged" : "")});
  table.Add({"smallest p-value", Number(tests.smallest_p), SmallestText(tests)});
  return table.Lines();
}

/// What stood aside, if anything did.
std::vector<std::string> CountLines(const ImageDifference& difference) {
  std::vector<std::string> lines;
  const AgreementTests& tests = difference.tests;
  if (difference.excluded > 0) {
    lines.push_back(absl::StrFormat("%d of %d pixels left out: not finite in one of the images",
                                    difference.excluded, difference.excluded + difference.pixels));
  }
  if (tests.constant_equal > 0) {
    lines.push_back(absl::StrFormat("%d means of tiles without noise are equal, and not tested",
                                    tests.constant_equal));
  }
  return lines;
}

std::string VerdictLine(const DiffImage& a, const DiffImage& b, const ImageDifference& difference) {
  switch (difference.verdict) {
    case Verdict::kIdentical: {
      const std::string digest = MetadataValue(a.layers, "digest");
      return !digest.empty() && digest == MetadataValue(b.layers, "digest")
                 ? absl::StrCat("identical result: ", Printable(digest))
                 : "identical: every pixel is equal";
    }
    case Verdict::kAgree:
      return absl::StrCat("they agree: no test is below ", kDifferenceLevel);
    case Verdict::kDisagree:
      return absl::StrCat("they disagree: a test is below ", kDifferenceLevel);
    case Verdict::kNotTested:
      break;
  }
  return "agreement is not tested";
}

/// The three channels' `field`, times `factor`.
template <typename Channels, typename Field>
Json ChannelsJson(const Channels& channels, Field field, double factor = 1) {
  return Json::array(
      {factor * channels[0].*field, factor * channels[1].*field, factor * channels[2].*field});
}

Json TestsJson(const AgreementTests& tests) {
  const auto& channels = tests.channels;
  Json json = {{"level", kDifferenceLevel},
               {"claimed_mse_rgb", ChannelsJson(channels, &ChannelTest::claimed_mse)},
               {"bias_stderr_rgb", ChannelsJson(channels, &ChannelTest::standard_error)},
               {"detectable_bias_rgb",
                ChannelsJson(channels, &ChannelTest::standard_error, kDetectableErrors)},
               {"detectable_tile_bias_rgb",
                ChannelsJson(channels, &ChannelTest::tile_error, kDetectableErrors)},
               {"bias_p_rgb", ChannelsJson(channels, &ChannelTest::bias_p)},
               {"bias_p", tests.bias_p},
               {"uniformity_p_rgb", ChannelsJson(channels, &ChannelTest::uniformity_p)},
               {"uniformity_p", tests.uniformity_p},
               {"uniformity_tests", tests.uniformity_tests},
               {"smallest_p", tests.smallest_p},
               {"smallest_raw_p", tests.smallest_raw_p},
               {"tests", tests.tests},
               {"smallest_tile", tests.tests == 0 ? Json(nullptr) : RectJson(tests.smallest_tile)},
               {"smallest_channel",
                tests.tests == 0 ? Json(nullptr) : Json(kColourNames[tests.smallest_channel])},
               {"constant_equal", tests.constant_equal},
               {"constant_different", tests.constant_different},
               {"uneven_tiles", tests.uneven_tiles}};
  return json;
}

}  // namespace

std::vector<std::string> DiffWarnings(const DiffImage& a, const DiffImage& b,
                                      const ImageDifference& difference) {
  std::vector<std::string> warnings;
  const PixelRect &a_crop = a.layers.crop, &b_crop = b.layers.crop;
  if (a_crop.x0 != b_crop.x0 || a_crop.y0 != b_crop.y0) {
    warnings.push_back(absl::StrFormat(
        "the images lie at different places of their frames (%d,%d and %d,%d); they are compared "
        "pixel by pixel from the top left",
        a_crop.x0, a_crop.y0, b_crop.x0, b_crop.y0));
  }
  if (difference.pixels == 0) warnings.emplace_back("no pixel is finite in both images");
  if (difference.verdict == Verdict::kIdentical) return warnings;
  if (!difference.has_errors) {
    warnings.emplace_back(
        "agreement is not tested: one of the images has no standard errors (stderr.R, stderr.G, "
        "stderr.B)");
    return warnings;
  }
  if (difference.shared_randomness) {
    warnings.push_back(
        absl::StrCat("both images were rendered with the same random numbers (seed ",
                     Printable(MetadataValue(a.layers, "seed")), ", frame ",
                     Printable(MetadataValue(a.layers, "frame")),
                     "), so that agreement would say nothing; render one with another --seed"));
  }
  if (difference.tests.uneven_tiles > 0) {
    warnings.push_back(absl::StrFormat(
        "sample counts differ by more than half in %d tiles: where noise is skewed, that makes "
        "small p-values too frequent; compare images of equal counts",
        difference.tests.uneven_tiles));
  }
  return warnings;
}

std::vector<std::string> DiffLines(const DiffImage& a, const DiffImage& b,
                                   const ImageDifference& difference) {
  std::vector<std::string> lines = {absl::StrCat("A  ", ImageLine(a)),
                                    absl::StrCat("B  ", ImageLine(b), " (the reference)")};
  const auto append = [&](const std::vector<std::string>& more) {
    lines.insert(lines.end(), more.begin(), more.end());
  };
  if (difference.verdict != Verdict::kIdentical) {
    append(MetricLines(difference));
    if (difference.has_errors) append(TestLines(difference));
  }
  append(CountLines(difference));
  lines.push_back(VerdictLine(a, b, difference));
  return lines;
}

std::string DiffEvent(const DiffImage& a, const DiffImage& b, const ImageDifference& difference,
                      const std::vector<std::string>& warnings) {
  const auto& channels = difference.channels;
  const Json json = {{"event", "diff"},
                     {"a", a.path},
                     {"b", b.path},
                     {"width", difference.width},
                     {"height", difference.height},
                     {"pixels", difference.pixels},
                     {"excluded", difference.excluded},
                     {"mse", difference.all.mse},
                     {"rel_mse", difference.all.relative_mse},
                     {"mrse", difference.all.mrse},
                     {"bias", difference.all.bias},
                     {"mse_rgb", ChannelsJson(channels, &DifferenceMetrics::mse)},
                     {"rel_mse_rgb", ChannelsJson(channels, &DifferenceMetrics::relative_mse)},
                     {"mrse_rgb", ChannelsJson(channels, &DifferenceMetrics::mrse)},
                     {"bias_rgb", ChannelsJson(channels, &DifferenceMetrics::bias)},
                     {"verdict", std::string(ToString(difference.verdict))},
                     {"shared_randomness", difference.shared_randomness},
                     {"tests", difference.has_errors ? TestsJson(difference.tests) : Json(nullptr)},
                     {"warnings", warnings}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace strata
