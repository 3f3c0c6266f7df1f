#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/status.h"
#include "common/text.h"
#include "worker/scene/description.h"

namespace strata {

/// A word of a pbrt file. `text` points into the tokenizer's buffer.
struct Token {
  enum class Kind { kWord, kString, kOpen, kClose, kEnd };
  Kind kind = Kind::kEnd;
  std::string_view text;  ///< For kString: what stands between the quotes, escapes not yet undone.
  int line = 0;
};

/// INVALID_ARGUMENT that reads "file:line: what".
absl::Status ErrorAt(const SourceLocation& where, std::string_view what);

/// Cuts a pbrt-v4 file into tokens; comments and white space are dropped.
class Tokenizer {
 public:
  /// `file` is the name used in messages.
  Tokenizer(std::string file, std::string contents)
      : file_(std::move(file)), contents_(std::move(contents)) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (contents_.starts_with(kByteOrderMark)) position_ = kByteOrderMark.size();
  }
  Tokenizer(const Tokenizer&) = delete;
  Tokenizer& operator=(const Tokenizer&) = delete;

  /// The next token, of kind kEnd at the end of the file and ever after. INVALID_ARGUMENT for an
  /// unterminated string.
  absl::StatusOr<Token> Next();
  /// As Next, but the token stays.
  absl::StatusOr<Token> Peek();

  const std::string& file() const { return file_; }
  SourceLocation At(int line) const { return {file_, line}; }

 private:
  absl::StatusOr<Token> Scan();

  const std::string file_;
  const std::string contents_;
  size_t position_ = 0;
  int line_ = 1;
  std::optional<Token> peeked_;
};

/// The string a kString token stands for. INVALID_ARGUMENT for an unknown escape.
absl::StatusOr<std::string> Unescape(std::string_view quoted, const SourceLocation& where);

/// The finite number a word stands for. INVALID_ARGUMENT if it is none, is not finite or does not
/// fit a float.
absl::StatusOr<double> ParseNumber(std::string_view word, const SourceLocation& where);

}  // namespace strata
