#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>
#include <absl/strings/strip.h>

#include <cmath>

#include "cli/job_options.h"

namespace strata {
namespace {

absl::Status Wanted(const std::string& option, const std::string& given,
                    const std::string& wanted) {
  return absl::InvalidArgumentError(
      absl::StrCat("--", option, ": '", given, "' is not understood, give ", wanted));
}

}  // namespace

absl::StatusOr<Resolution> ParseResolution(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, 'x');
  Resolution resolution;
  if (parts.size() != 2 || !absl::SimpleAtoi(parts[0], &resolution.width) ||
      !absl::SimpleAtoi(parts[1], &resolution.height)) {
    return Wanted("resolution", text, "WIDTHxHEIGHT in pixels, such as 1280x720");
  }
  return resolution;
}

absl::StatusOr<PixelRect> ParseCrop(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ',');
  PixelRect crop;
  if (parts.size() != 4 || !absl::SimpleAtoi(parts[0], &crop.x0) ||
      !absl::SimpleAtoi(parts[1], &crop.y0) || !absl::SimpleAtoi(parts[2], &crop.x1) ||
      !absl::SimpleAtoi(parts[3], &crop.y1)) {
    return Wanted("crop", text, "x0,y0,x1,y1 in pixels (x1 and y1 excluded), such as 0,0,64,64");
  }
  return crop;
}

absl::StatusOr<FilterSpec> ParseFilter(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, absl::MaxSplits(':', 1));
  const absl::StatusOr<FilterKind> kind = ParseFilterKind(parts[0]);
  if (!kind.ok()) return Annotate(kind.status(), "--filter");
  FilterSpec filter = DefaultFilter(*kind);
  if (parts.size() == 1) return filter;
  std::vector<double*> values = {&filter.radius_x, &filter.radius_y};
  if (filter.kind == FilterKind::kGaussian) values.push_back(&filter.sigma);
  if (filter.kind == FilterKind::kMitchell) values.insert(values.end(), {&filter.b, &filter.c});
  const std::vector<std::string> numbers = absl::StrSplit(parts[1], ',');
  bool understood = numbers.size() == 1 || numbers.size() == 2 || numbers.size() == values.size();
  for (size_t i = 0; understood && i < numbers.size(); ++i) {
    understood = absl::SimpleAtod(numbers[i], values[i]) && std::isfinite(*values[i]);
  }
  if (!understood) {
    return Wanted("filter", text, "NAME or NAME:RADIUS in pixels, such as gaussian:1.5");
  }
  if (numbers.size() == 1) filter.radius_y = filter.radius_x;
  return filter;
}

absl::StatusOr<double> ParseRelativeError(const std::string& text) {
  absl::string_view number = text;
  const double unit = absl::ConsumeSuffix(&number, "%") ? 0.01 : 1;
  double value;
  if (!absl::SimpleAtod(number, &value) || !(value > 0) || !std::isfinite(value)) {
    return Wanted("error", text, "a relative error above 0, such as 0.02 or 2%");
  }
  return value * unit;
}

absl::StatusOr<double> ParseRmse(const std::string& text) {
  double value;
  if (!absl::SimpleAtod(text, &value) || !(value > 0) || !std::isfinite(value)) {
    return Wanted("rmse", text, "an error above 0 in units of the picture, such as 0.001");
  }
  return value;
}

absl::StatusOr<double> ParseTime(const std::string& text) {
  absl::string_view number = text;
  double unit = 1;
  if (absl::ConsumeSuffix(&number, "m")) {
    unit = 60;
  } else if (absl::ConsumeSuffix(&number, "h")) {
    unit = 3600;
  } else {
    absl::ConsumeSuffix(&number, "s");
  }
  double value;
  if (!absl::SimpleAtod(number, &value) || !(value > 0) || !std::isfinite(value)) {
    return Wanted("time", text, "a time above 0, such as 90s, 15m or 2h");
  }
  return value * unit;
}

absl::StatusOr<ExtraChannels> ParseChannels(const std::string& text) {
  ExtraChannels channels;
  const std::vector<std::string> names = absl::StrSplit(text, ',');
  for (const std::string& name : names) {
    if (name == "alpha") {
      channels.alpha = true;
    } else if (name == "albedo") {
      channels.albedo = true;
    } else if (name == "normal") {
      channels.normal = true;
    } else if (name == "depth") {
      channels.depth = true;
    } else {
      return Wanted("channels", name, "names out of alpha,albedo,normal,depth");
    }
  }
  return channels;
}

}  // namespace strata
