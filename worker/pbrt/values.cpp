#include "worker/pbrt/values.h"

#include <absl/strings/str_split.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "worker/pbrt/named_spectra.h"

namespace strata {
namespace {

using Samples = std::vector<std::pair<double, double>>;

Rgb ToLinearRec709(const std::vector<double>& rgb, std::string_view color_space) {
  if (color_space == "srgb") {
    return {static_cast<float>(rgb[0]), static_cast<float>(rgb[1]), static_cast<float>(rgb[2])};
  }
  const auto m = *ToRec709(color_space);  // the name was checked when it was set
  const auto row = [&](int i) {
    return static_cast<float>(m[i][0] * rgb[0] + m[i][1] * rgb[1] + m[i][2] * rgb[2]);
  };
  return {row(0), row(1), row(2)};
}

absl::StatusOr<Rgb> ReadRgb(const Parameter& parameter, SpectrumUse use,
                            std::string_view color_space) {
  if (parameter.numbers.size() != 3) {
    return ErrorAt(parameter.where, StrCat("\"rgb ", parameter.name, "\" wants three numbers"));
  }
  for (const double value : parameter.numbers) {
    if (value < 0 || (use == SpectrumUse::kReflectance && value > 1)) {
      return ErrorAt(parameter.where,
                     StrCat("\"rgb ", parameter.name, "\" holds ", value, "; it must be ",
                            use == SpectrumUse::kReflectance ? "within [0, 1]" : "not negative"));
    }
  }
  return ToLinearRec709(parameter.numbers, color_space);
}

/// Wavelength and value pairs from a text file, '#' starting comments.
absl::StatusOr<Spectrum> ReadSpectrumFile(const std::string& name, const SourceLocation& where,
                                          ReadContext& context) {
  absl::StatusOr<std::string> path = context.AddFile(name, where);
  if (absl::IsNotFound(path.status()))
    return ErrorAt(where, StrCat("\"", name, "\" is no named spectrum and no file"));
  if (!path.ok()) return path.status();
  STRATA_ASSIGN_OR_RETURN(const std::string text, context.ReadText(*path, where));
  Samples samples;
  int line_number = 0;
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    const SourceLocation at = {*path, ++line_number};
    line = line.substr(0, line.find('#'));
    const std::vector<absl::string_view> words =
        absl::StrSplit(line, absl::ByAnyChar(" \t\r,"), absl::SkipWhitespace());
    if (words.empty()) continue;
    if (words.size() != 2)
      return ErrorAt(at, "a line of a spectrum wants a wavelength and a value");
    STRATA_ASSIGN_OR_RETURN(const double wavelength,
                            ParseNumber({words[0].data(), words[0].size()}, at));
    STRATA_ASSIGN_OR_RETURN(const double value,
                            ParseNumber({words[1].data(), words[1].size()}, at));
    if (value < 0) {
      return ErrorAt(at, StrCat("a spectrum holds the value ", value, "; it must not be negative"));
    }
    samples.emplace_back(wavelength, value);
  }
  absl::StatusOr<Spectrum> spectrum = Spectrum::Create(std::move(samples));
  if (!spectrum.ok()) return Annotate(spectrum.status(), *path);
  return spectrum;
}

absl::StatusOr<Spectrum> ReadBlackbody(const Parameter& parameter) {
  if (parameter.numbers.size() != 1 || !(parameter.numbers[0] >= 100) ||
      !(parameter.numbers[0] <= 1e7)) {
    return ErrorAt(parameter.where, StrCat("\"blackbody ", parameter.name,
                                           "\" wants one temperature of 100 to 1e7 K"));
  }
  return Spectrum::Blackbody(parameter.numbers[0]);
}

absl::Status CheckRange(const Parameter& parameter, SpectrumUse use) {
  for (size_t i = 1; i < parameter.numbers.size(); i += 2) {
    if (parameter.numbers[i] < 0 ||
        (use == SpectrumUse::kReflectance && parameter.numbers[i] > 1)) {
      return ErrorAt(parameter.where,
                     StrCat("\"spectrum ", parameter.name, "\" holds the value ",
                            parameter.numbers[i], "; it must be ",
                            use == SpectrumUse::kReflectance ? "within [0, 1]" : "not negative"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<Spectrum> ReadSpectrum(const Parameter& parameter, ReadContext& context) {
  if (parameter.type == "blackbody") return ReadBlackbody(parameter);
  if (!parameter.strings.empty()) {
    if (parameter.strings.size() != 1) {
      return ErrorAt(parameter.where, StrCat("\"spectrum ", parameter.name, "\" wants one name"));
    }
    if (std::optional<Spectrum> named = NamedSpectrum(parameter.strings[0])) return *named;
    return ReadSpectrumFile(parameter.strings[0], parameter.where, context);
  }
  if (parameter.numbers.size() % 2 != 0) {
    return ErrorAt(parameter.where,
                   StrCat("\"spectrum ", parameter.name, "\" wants pairs of wavelength and value"));
  }
  Samples samples;
  for (size_t i = 0; i + 1 < parameter.numbers.size(); i += 2) {
    samples.emplace_back(parameter.numbers[i], parameter.numbers[i + 1]);
  }
  absl::StatusOr<Spectrum> spectrum = Spectrum::Create(std::move(samples));
  if (!spectrum.ok()) return Annotate(spectrum.status(), parameter.where.ToString());
  return spectrum;
}

absl::StatusOr<Rgb> ReadColor(const Parameter& parameter, SpectrumUse use,
                              std::string_view color_space, ReadContext& context) {
  if (parameter.type == "rgb") return ReadRgb(parameter, use, color_space);
  if (parameter.type != "spectrum" && parameter.type != "blackbody") {
    return ErrorAt(parameter.where, StrCat("\"", parameter.type, " ", parameter.name,
                                           "\" must be of type rgb, spectrum or blackbody"));
  }
  STRATA_RETURN_IF_ERROR(CheckRange(parameter, use));
  STRATA_ASSIGN_OR_RETURN(const Spectrum spectrum, ReadSpectrum(parameter, context));
  Rgb color =
      use == SpectrumUse::kIlluminant ? IlluminantColor(spectrum) : ReflectanceColor(spectrum);
  if (!IsFinite(color)) {
    return ErrorAt(parameter.where,
                   StrCat("\"", parameter.type, " ", parameter.name, "\" is too large"));
  }
  if (use == SpectrumUse::kReflectance) {
    // Pure colours lie outside the gamut of Rec.709.
    color = {std::min(color.r, 1.0f), std::min(color.g, 1.0f), std::min(color.b, 1.0f)};
  }
  return color;
}

Rgb ColorParameter(ParameterReader& parameters, std::string_view name, Rgb fallback,
                   SpectrumUse use, std::string_view color_space, ReadContext& context) {
  const Parameter* parameter = parameters.Take(name);
  if (!parameter) return fallback;
  absl::StatusOr<Rgb> color = ReadColor(*parameter, use, color_space, context);
  if (color.ok()) return *color;
  parameters.Fail(color.status());
  return fallback;
}

}  // namespace strata
