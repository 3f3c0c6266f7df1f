#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

// Numbers and tables as people read them.

namespace strata {

/// "0.84 s", "12 s", "3 min 05 s", "2 h 03 min", "4 d 07 h".
std::string FormatDuration(double seconds);
/// Three digits and a decimal prefix: "950", "12.3 k", "1.23 M", "4.50 G".
std::string FormatCount(double count);
/// "812 B", "12.3 kB", "1.23 MB".
std::string FormatBytes(double bytes);
/// Two significant digits: 0.0312 becomes "3.1 %".
std::string FormatPercent(double share);
/// Local time, "2024-05-31 14:03:09".
std::string FormatTime(double unix_seconds);

/// `text` with every control character replaced by '?': what other people named their jobs must not
/// move the cursor of this terminal.
std::string Printable(std::string_view text);
/// Columns that UTF-8 text takes, counting each code point as one.
int DisplayWidth(std::string_view text);

/// Rows of cells, printed in aligned columns.
class Table {
 public:
  struct Column {
    std::string title;
    bool right = false;  ///< Numbers are aligned to the right.
  };
  explicit Table(std::vector<Column> columns) : columns_(std::move(columns)) {}
  /// One cell for each column.
  void Add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  /// The title line and the rows, without trailing blanks.
  std::vector<std::string> Lines() const;

 private:
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace strata
