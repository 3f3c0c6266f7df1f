#include "cli/lab/report.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <absl/strings/str_replace.h>
#include <absl/strings/str_split.h>

#include <algorithm>

namespace strata::lab {
namespace {

constexpr size_t kLineWidth = 100;

bool IsNumber(const Cell& cell) { return std::holds_alternative<double>(cell); }

/// Broken between words.
std::vector<std::string> Wrapped(const std::string& text) {
  std::vector<std::string> lines;
  std::string line;
  for (const absl::string_view word : absl::StrSplit(text, ' ')) {
    if (!line.empty() && line.size() + 1 + word.size() > kLineWidth) {
      lines.push_back(line);
      line.clear();
    }
    absl::StrAppend(&line, line.empty() ? "" : " ", word);
  }
  lines.push_back(line);
  return lines;
}

std::vector<std::string> Texts(const std::vector<Cell>& row) {
  std::vector<std::string> texts;
  for (const Cell& cell : row) texts.push_back(ToText(cell));
  return texts;
}

/// Whether a column's cells are aligned to the right: numbers.
bool IsOfNumbers(const Records& records, size_t column) {
  return !records.rows.empty() && IsNumber(records.rows.front()[column]);
}

std::string Quoted(const std::string& words) {
  if (words.find_first_of(",\"\n") == std::string::npos) return words;
  return absl::StrCat("\"", absl::StrReplaceAll(words, {{"\"", "\"\""}}), "\"");
}

std::string MarkdownRow(const std::vector<std::string>& cells) {
  return absl::StrCat("| ", absl::StrJoin(cells, " | "), " |");
}

}  // namespace

std::vector<std::string> TextLines(const Experiment& experiment, const Outcome& outcome) {
  const Records& records = outcome.records;
  std::vector<std::vector<std::string>> rows = {records.columns};
  for (const std::vector<Cell>& row : records.rows) rows.push_back(Texts(row));
  std::vector<size_t> widths(records.columns.size(), 0);
  for (const std::vector<std::string>& row : rows) {
    for (size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  std::vector<std::string> lines = Wrapped(std::string(experiment.sentence));
  lines.emplace_back();
  for (const std::vector<std::string>& row : rows) {
    std::string line;
    for (size_t i = 0; i < row.size(); ++i) {
      const std::string blanks(widths[i] - row[i].size(), ' ');
      absl::StrAppend(&line, i > 0 ? "  " : "",
                      IsOfNumbers(records, i) ? blanks + row[i] : row[i] + blanks);
    }
    lines.emplace_back(absl::StripTrailingAsciiWhitespace(line));
  }
  for (const std::string& remark : outcome.remarks) {
    lines.emplace_back();
    for (std::string& line : Wrapped(remark)) lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<std::string> CsvLines(const Records& records) {
  std::vector<std::string> titles;
  for (const std::string& column : records.columns) titles.push_back(Quoted(column));
  std::vector<std::string> lines = {absl::StrJoin(titles, ",")};
  for (const std::vector<Cell>& row : records.rows) {
    std::vector<std::string> cells;
    for (const Cell& cell : row) {
      if (!IsNumber(cell)) {
        cells.push_back(Quoted(std::get<std::string>(cell)));
        continue;
      }
      const double number = std::get<double>(cell);
      cells.push_back(std::isnan(number) ? "" : absl::StrFormat("%.9g", number));
    }
    lines.push_back(absl::StrJoin(cells, ","));
  }
  return lines;
}

std::vector<std::string> MarkdownLines(const Experiment& experiment, const Outcome& outcome,
                                       const std::string& picture) {
  const Records& records = outcome.records;
  std::vector<std::string> lines = {absl::StrCat("## ", experiment.name), "",
                                    std::string(experiment.sentence), ""};
  if (!picture.empty()) {
    lines.push_back(absl::StrCat("![", outcome.caption, "](", picture, ")"));
    lines.insert(lines.end(), {"", outcome.caption, ""});
  }
  for (const std::string& remark : outcome.remarks) lines.insert(lines.end(), {remark, ""});
  lines.push_back(MarkdownRow(records.columns));
  std::vector<std::string> rules;
  for (size_t i = 0; i < records.columns.size(); ++i)
    rules.emplace_back(IsOfNumbers(records, i) ? "---:" : "---");
  lines.push_back(MarkdownRow(rules));
  for (const std::vector<Cell>& row : records.rows) lines.push_back(MarkdownRow(Texts(row)));
  lines.emplace_back();
  return lines;
}

}  // namespace strata::lab
