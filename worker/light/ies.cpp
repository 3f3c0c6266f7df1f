#include "worker/light/ies.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>
#include <absl/strings/numbers.h>
#include <absl/strings/string_view.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "worker/math/elementary.h"

namespace strata {
namespace {

constexpr double kMaxAngles = 10000;

/// The file's lines, and the numbers that follow them, which may be broken into lines anywhere.
class IesText {
 public:
  IesText(absl::string_view text, const std::string& name) : rest_(text), name_(name) {}

  std::optional<absl::string_view> NextLine() {
    if (rest_.empty()) return std::nullopt;
    read_line_ = line_++;
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    const absl::string_view line = rest_.substr(0, end);
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    return absl::StripAsciiWhitespace(line);
  }

  /// `what` it is, for the message should it be missing.
  absl::StatusOr<double> NextNumber(absl::string_view what) {
    const auto between = [](char c) { return absl::ascii_isspace(c) || c == ','; };
    while (!rest_.empty() && between(rest_.front())) {
      if (rest_.front() == '\n') ++line_;
      rest_.remove_prefix(1);
    }
    read_line_ = line_;
    size_t end = 0;
    while (end < rest_.size() && !between(rest_[end])) ++end;
    const absl::string_view word = rest_.substr(0, end);
    double value = 0;
    if (word.empty())
      return Error(absl::StrCat("the file ends where ", what, " must be; it was cut short"));
    if (!absl::SimpleAtod(word, &value) || !std::isfinite(value))
      return Error(absl::StrCat("\"", word.substr(0, 40), "\" is where ", what, " must be"));
    rest_.remove_prefix(end);
    return value;
  }

  absl::StatusOr<std::vector<float>> NextNumbers(double count, absl::string_view what) {
    std::vector<float> values;
    for (int i = 0; i < static_cast<int>(count); ++i) {
      STRATA_ASSIGN_OR_RETURN(const double value,
                              NextNumber(absl::StrCat(what, " ", i + 1, " of ", count)));
      values.push_back(static_cast<float>(value));
    }
    return values;
  }

  absl::Status Error(absl::string_view what) const {
    return absl::InvalidArgumentError(absl::StrCat(name_, ":", read_line_, ": ", what));
  }

 private:
  absl::string_view rest_;
  std::string name_;
  int line_ = 1;       ///< Where the rest begins.
  int read_line_ = 1;  ///< Of what was read last.
};

/// Goes on to the numbers, past the keywords and what is said of tilted lamps.
absl::Status SkipHeader(IesText& text) {
  while (true) {
    const std::optional<absl::string_view> line = text.NextLine();
    if (!line) return text.Error("there is no line TILT=...; this is no IES file (LM-63)");
    if (!absl::StartsWith(*line, "TILT=")) continue;
    const absl::string_view tilt = absl::StripAsciiWhitespace(line->substr(5));
    if (tilt == "NONE") return absl::OkStatus();
    if (tilt != "INCLUDE")
      return text.Error(
          absl::StrCat("TILT names the file \"", tilt, "\", which is not read; write TILT=NONE"));
    STRATA_RETURN_IF_ERROR(text.NextNumber("the lamp's place in the luminaire").status());
    STRATA_ASSIGN_OR_RETURN(const double pairs, text.NextNumber("the number of tilt angles"));
    if (!(pairs >= 0 && pairs <= kMaxAngles)) return text.Error("the tilt angles are too many");
    return text.NextNumbers(2 * pairs, "tilt angle or factor").status();
  }
}

absl::Status CheckIncreasing(const IesText& text, const std::vector<float>& angles,
                             absl::string_view which) {
  for (size_t i = 1; i < angles.size(); ++i) {
    if (!(angles[i] > angles[i - 1]))
      return text.Error(absl::StrCat("the ", which, " angles do not increase: ", angles[i],
                                     " follows ", angles[i - 1]));
  }
  return absl::OkStatus();
}

/// A horizontal angle, and which of the file's it is like.
struct Column {
  float angle;
  size_t source;
};

/// The file's horizontal angles turned into a full circle by the symmetry that their range means.
absl::StatusOr<std::vector<Column>> FullCircle(const IesText& text,
                                               const std::vector<float>& angles) {
  std::vector<Column> columns;
  for (size_t i = 0; i < angles.size(); ++i) columns.push_back({angles[i], i});
  const float first = angles.front(), last = angles.back();
  if (angles.size() == 1) {
    columns[0].angle = 0;
    return columns;
  }
  // Appends what is mirrored at the last angle.
  const auto mirror = [&] {
    const float at = columns.back().angle;
    for (size_t i = columns.size() - 1; i-- > 0;)
      columns.push_back({2 * at - columns[i].angle, columns[i].source});
  };
  if (first == 0 && last == 90) {
    mirror();
    mirror();
  } else if (first == 0 && last == 180) {
    mirror();
  } else if (first == 90 && last == 270) {
    // Mirrored at 270 degrees, on to 450; what goes beyond a turn is moved back to its beginning.
    mirror();
    std::vector<Column> turned;
    for (const Column& column : columns)
      if (column.angle >= 360) turned.push_back({column.angle - 360, column.source});
    for (const Column& column : columns)
      if (column.angle <= 360 && (turned.empty() || column.angle > turned.back().angle))
        turned.push_back(column);
    columns = std::move(turned);
    if (columns.front().angle > 0 || columns.back().angle < 360)
      return text.Error("horizontal angles from 90 to 270 degrees must have 180 among them");
  } else if (first == 0 && last > 180 && last <= 360) {
    if (last < 360) columns.push_back({360, 0});
  } else {
    return text.Error(absl::StrCat("the horizontal angles go from ", first, " to ", last,
                                   " degrees; they must be 0 alone or go from 0 to 90, to 180 or "
                                   "around, or from 90 to 270"));
  }
  return columns;
}

/// The place of x between increasing values: values[index] to values[index + 1] at `part`.
struct Place {
  size_t index = 0;
  float part = 0;
};
Place PlaceOf(const std::vector<float>& values, float x) {
  if (values.size() < 2) return {};
  const auto above = std::upper_bound(values.begin() + 1, values.end() - 1, x);
  const size_t index = static_cast<size_t>(above - values.begin()) - 1;
  const float part = (x - values[index]) / (values[index + 1] - values[index]);
  return {index, std::clamp(part, 0.0f, 1.0f)};
}

}  // namespace

bool IsIesFile(const std::string& path) { return absl::EndsWithIgnoreCase(path, ".ies"); }

absl::StatusOr<IesProfile> IesProfile::Parse(std::string_view file, const std::string& name) {
  IesText text({file.data(), file.size()}, name);
  STRATA_RETURN_IF_ERROR(SkipHeader(text));
  STRATA_RETURN_IF_ERROR(text.NextNumber("the number of lamps").status());
  STRATA_RETURN_IF_ERROR(text.NextNumber("the lumens of a lamp").status());
  STRATA_ASSIGN_OR_RETURN(const double multiplier, text.NextNumber("the candela multiplier"));
  STRATA_ASSIGN_OR_RETURN(const double verticals, text.NextNumber("the number of vertical angles"));
  STRATA_ASSIGN_OR_RETURN(const double horizontals,
                          text.NextNumber("the number of horizontal angles"));
  const auto is_count = [](double n) { return n >= 1 && n <= kMaxAngles && n == std::floor(n); };
  if (!is_count(verticals) || verticals < 2 || !is_count(horizontals))
    return text.Error(absl::StrCat("there are ", verticals, " vertical and ", horizontals,
                                   " horizontal angles; at least 2 and 1, and no more than ",
                                   kMaxAngles, ", are read"));
  STRATA_ASSIGN_OR_RETURN(const double type, text.NextNumber("the photometric type"));
  if (type != 1)
    return text.Error(absl::StrCat("the photometric type is ", type,
                                   "; only type C (1) is read, convert the file"));
  STRATA_RETURN_IF_ERROR(text.NextNumbers(4, "unit or size").status());
  STRATA_ASSIGN_OR_RETURN(const double ballast, text.NextNumber("the ballast factor"));
  STRATA_ASSIGN_OR_RETURN(const double lamp, text.NextNumber("the ballast-lamp factor"));
  STRATA_RETURN_IF_ERROR(text.NextNumber("the input watts").status());
  const double factor = multiplier * ballast * lamp;
  if (!(factor > 0) || !std::isfinite(factor))
    return text.Error("the candela multiplier and the ballast factors must be more than 0");

  IesProfile profile;
  STRATA_ASSIGN_OR_RETURN(profile.vertical, text.NextNumbers(verticals, "vertical angle"));
  STRATA_RETURN_IF_ERROR(CheckIncreasing(text, profile.vertical, "vertical"));
  if (profile.vertical.front() < 0 || profile.vertical.back() > 180)
    return text.Error("the vertical angles must lie between 0 and 180 degrees");
  STRATA_ASSIGN_OR_RETURN(const std::vector<float> angles,
                          text.NextNumbers(horizontals, "horizontal angle"));
  STRATA_RETURN_IF_ERROR(CheckIncreasing(text, angles, "horizontal"));
  STRATA_ASSIGN_OR_RETURN(const std::vector<Column> columns, FullCircle(text, angles));
  STRATA_ASSIGN_OR_RETURN(const std::vector<float> values,
                          text.NextNumbers(verticals * horizontals, "candela value"));
  for (const float value : values) {
    if (value < 0) return text.Error(absl::StrCat("a candela value is ", value, ", below 0"));
  }
  const size_t rows = profile.vertical.size();
  for (const Column& column : columns) {
    profile.horizontal.push_back(column.angle);
    for (size_t row = 0; row < rows; ++row) {
      const double candelas = factor * values[column.source * rows + row];
      if (!(candelas <= std::numeric_limits<float>::max()))
        return text.Error("a candela value times the multiplier is beyond all numbers");
      profile.candelas.push_back(static_cast<float>(candelas));
    }
  }
  return profile;
}

float IesProfile::Candelas(Vec3f direction) const {
  constexpr float kDegrees = 180 * kInvPi;
  const float across = std::sqrt(direction.x * direction.x + direction.y * direction.y);
  const float gamma = Atan2(across, -direction.z) * kDegrees;
  // Angles of the file may be rounded.
  constexpr float kSlack = 1e-3f;
  if (gamma < vertical.front() - kSlack || gamma > vertical.back() + kSlack) return 0;
  float phi = across > 0 ? Atan2(direction.y, direction.x) * kDegrees : 0;
  if (phi < 0) phi += 360;
  const Place v = PlaceOf(vertical, gamma), h = PlaceOf(horizontal, phi);
  const auto column = [&](size_t index) {
    const float* values = &candelas[index * vertical.size() + v.index];
    return values[0] + (values[1] - values[0]) * v.part;
  };
  const float low = column(h.index);
  return h.part > 0 ? low + (column(h.index + 1) - low) * h.part : low;
}

}  // namespace strata
