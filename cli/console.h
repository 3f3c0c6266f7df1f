#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace strata {

/// Where a command's words go: results to stdout, everything else to stderr, or to the streams
/// given in their place. One thread.
class Console {
 public:
  /// What standard error can show.
  struct Terminal {
    bool live = false;    ///< It is a terminal: a line may be redrawn in place.
    bool colour = false;  ///< Live, and NO_COLOR (no-color.org) is not set.
  };
  /// Looks at the process's standard error and environment.
  static Console ForProcess();
  /// The streams stay the caller's.
  explicit Console(Terminal terminal, std::FILE* results = stdout, std::FILE* others = stderr)
      : terminal_(terminal), results_(results), others_(others) {}

  /// A line of result, flushed, so that a reader behind a pipe sees it at once.
  void Result(std::string_view line);
  /// A line for the person who waits.
  void Note(std::string_view line);
  void Warning(std::string_view line);
  /// One line however `message` was broken; control characters are made harmless. Nothing comes
  /// before it, so that "file:line:" stays where editors look for it.
  void Error(std::string_view message);

  bool live() const { return terminal_.live; }
  /// Columns of the terminal now (it may be resized); 80 where nothing tells.
  int Width() const;
  /// Shows `line` in place of the line shown before; it must fit the width.
  void Redraw(std::string_view line);
  /// Takes the redrawn line away.
  void Clear();

  /// `text` in bold, or as it is without colour.
  std::string Bold(std::string_view text) const { return Styled("1", text); }
  std::string Green(std::string_view text) const { return Styled("32", text); }
  std::string Yellow(std::string_view text) const { return Styled("33", text); }
  std::string Red(std::string_view text) const { return Styled("31", text); }

 private:
  std::string Styled(std::string_view code, std::string_view text) const;
  void Line(std::string_view line);

  Terminal terminal_;
  std::FILE* results_;
  std::FILE* others_;
  bool drawn_ = false;  ///< A redrawn line is on the screen.
};

}  // namespace strata
