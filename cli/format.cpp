#include "cli/format.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <ctime>

namespace strata {
namespace {

/// Three significant digits of a number below 1000 - the rounding included.
std::string ThreeDigits(double value) {
  if (value < 9.995) return absl::StrFormat("%.2f", value);
  if (value < 99.95) return absl::StrFormat("%.1f", value);
  return absl::StrFormat("%.0f", value);
}

/// The number scaled to below 1000 with its prefix, whole if it needs none.
std::string WithPrefix(double value, const char* unit) {
  static constexpr const char* kPrefixes[] = {"", "k", "M", "G", "T", "P"};
  size_t prefix = 0;
  while (value >= 999.5 && prefix + 1 < std::size(kPrefixes)) {
    value /= 1000;
    ++prefix;
  }
  const std::string number = prefix == 0 ? absl::StrFormat("%.0f", value) : ThreeDigits(value);
  const std::string suffix = absl::StrCat(kPrefixes[prefix], unit);
  return suffix.empty() ? number : absl::StrCat(number, " ", suffix);
}

}  // namespace

std::string FormatDuration(double seconds) {
  if (seconds < 9.995) return absl::StrFormat("%.2f s", seconds);
  const auto whole = static_cast<int64_t>(std::llround(seconds));
  if (whole < 60) return absl::StrFormat("%d s", whole);
  if (whole < 3600) return absl::StrFormat("%d min %02d s", whole / 60, whole % 60);
  if (whole < 86400) return absl::StrFormat("%d h %02d min", whole / 3600, whole % 3600 / 60);
  return absl::StrFormat("%d d %02d h", whole / 86400, whole % 86400 / 3600);
}

std::string FormatCount(double count) { return WithPrefix(count, ""); }
std::string FormatBytes(double bytes) { return WithPrefix(bytes, "B"); }

std::string FormatPercent(double share) {
  const double percent = 100 * share;
  if (percent >= 9.95 || percent == 0) return absl::StrFormat("%.0f %%", percent);
  if (percent >= 0.995) return absl::StrFormat("%.1f %%", percent);
  if (percent >= 0.0995) return absl::StrFormat("%.2f %%", percent);
  return absl::StrFormat("%.2g %%", percent);
}

std::string FormatTime(double unix_seconds) {
  const auto time = static_cast<std::time_t>(unix_seconds);
  std::tm local{};
  localtime_r(&time, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S", &local);
  return text;
}

std::string Printable(std::string_view text) {
  std::string result(text);
  for (char& c : result) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f) c = '?';
  }
  return result;
}

int DisplayWidth(std::string_view text) {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xc0) == 0x80; };
  return static_cast<int>(text.size() - std::ranges::count_if(text, continues));
}

std::vector<std::string> Table::Lines() const {
  std::vector<int> widths;
  for (const Column& column : columns_) widths.push_back(DisplayWidth(column.title));
  for (const auto& row : rows_) {
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], DisplayWidth(row[i]));
  }
  const auto line = [&](auto&& cell) {
    std::string text;
    for (size_t i = 0; i < columns_.size(); ++i) {
      const std::string& value = cell(i);
      const std::string padding(static_cast<size_t>(widths[i] - DisplayWidth(value)), ' ');
      if (i > 0) text += "  ";
      text += columns_[i].right ? padding + value : value + padding;
    }
    text.erase(text.find_last_not_of(' ') + 1);
    return text;
  };
  std::vector<std::string> lines = {
      line([&](size_t i) -> const std::string& { return columns_[i].title; })};
  for (const auto& row : rows_) {
    lines.push_back(line([&](size_t i) -> const std::string& { return row[i]; }));
  }
  return lines;
}

}  // namespace strata
