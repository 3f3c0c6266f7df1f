#include "worker/pbrt/tokenizer.h"

#include <charconv>
#include <cmath>
#include <limits>

namespace strata {
namespace {

bool IsSpace(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

bool EndsWord(char c) {
  return IsSpace(c) || c == '[' || c == ']' || c == '"' || c == '#' || c == '\0';
}

/// What a message may quote of a word of any length and content.
std::string Quotable(std::string_view word) {
  std::string text;
  for (const char c : word.substr(0, 40)) {
    text +=
        (static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) >= 0x7f) ? '?' : c;
  }
  return word.size() > 40 ? text + "..." : text;
}

}  // namespace

absl::Status ErrorAt(const SourceLocation& where, std::string_view what) {
  return absl::InvalidArgumentError(StrCat(where.ToString(), ": ", what));
}

absl::StatusOr<Token> Tokenizer::Next() {
  if (peeked_) {
    const Token token = *peeked_;
    peeked_.reset();
    return token;
  }
  return Scan();
}

absl::StatusOr<Token> Tokenizer::Peek() {
  if (!peeked_) {
    STRATA_ASSIGN_OR_RETURN(const Token token, Scan());
    peeked_ = token;
  }
  return *peeked_;
}

absl::StatusOr<Token> Tokenizer::Scan() {
  const std::string_view text = contents_;
  for (; position_ < text.size(); ++position_) {
    const char c = text[position_];
    if (c == '\n') {
      ++line_;
    } else if (c == '#') {
      position_ = std::min(text.find('\n', position_), text.size()) - 1;
    } else if (!IsSpace(c)) {
      break;
    }
  }
  if (position_ >= text.size()) return Token{Token::Kind::kEnd, {}, line_};

  const size_t start = position_++;
  switch (text[start]) {
    case '[':
      return Token{Token::Kind::kOpen, text.substr(start, 1), line_};
    case ']':
      return Token{Token::Kind::kClose, text.substr(start, 1), line_};
    case '"':
      for (; position_ < text.size() && text[position_] != '\n'; ++position_) {
        if (text[position_] == '"') {
          const Token token{Token::Kind::kString, text.substr(start + 1, position_ - start - 1),
                            line_};
          ++position_;
          return token;
        }
        if (text[position_] == '\\' && position_ + 1 < text.size()) ++position_;
      }
      return ErrorAt(At(line_), "the string does not end on its line; close it with a quote");
    default:
      while (position_ < text.size() && !EndsWord(text[position_])) ++position_;
      return Token{Token::Kind::kWord, text.substr(start, position_ - start), line_};
  }
}

absl::StatusOr<std::string> Unescape(std::string_view quoted, const SourceLocation& where) {
  std::string text;
  text.reserve(quoted.size());
  for (size_t i = 0; i < quoted.size(); ++i) {
    if (quoted[i] != '\\') {
      text += quoted[i];
      continue;
    }
    constexpr std::string_view kEscapes = "bfnrt\\'\"", kMeanings = "\b\f\n\r\t\\'\"";
    const size_t which =
        i + 1 < quoted.size() ? kEscapes.find(quoted[i + 1]) : std::string_view::npos;
    if (which == std::string_view::npos) {
      return ErrorAt(where, StrCat("\"", Quotable(quoted),
                                   "\" has an unknown escape; write \\\\ for a backslash"));
    }
    text += kMeanings[which];
    ++i;
  }
  return text;
}

absl::StatusOr<double> ParseNumber(std::string_view word, const SourceLocation& where) {
  double value = 0;
  const char* begin = word.data() + (word.starts_with('+') ? 1 : 0);
  const char* end = word.data() + word.size();
  const auto [stop, error] = std::from_chars(begin, end, value);
  if (stop != end || error == std::errc::invalid_argument || word.starts_with("+-")) {
    return ErrorAt(where, StrCat("\"", Quotable(word), "\" is no number"));
  }
  if (error == std::errc::result_out_of_range) {
    // Too small for a double is nothing to complain of.
    return word.find("e-") != word.npos || word.find("E-") != word.npos
               ? absl::StatusOr<double>(0.0)
               : ErrorAt(where, StrCat("the number ", Quotable(word), " is too large"));
  }
  if (!std::isfinite(value)) {
    return ErrorAt(where, StrCat("the number ", Quotable(word), " is not finite"));
  }
  if (std::fabs(value) > std::numeric_limits<float>::max()) {
    return ErrorAt(where, StrCat("the number ", Quotable(word), " is too large"));
  }
  return value;
}

}  // namespace strata
