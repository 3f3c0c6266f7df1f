#include "worker/pbrt/parameters.h"

#include <absl/strings/ascii.h>
#include <absl/strings/str_split.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace strata {
namespace {

/// No directive of pbrt-v4 knows nearly as many.
constexpr size_t kMaxParameters = 1000;

enum class ValueKind { kNumbers, kStrings, kBools, kNumbersOrStrings };

struct ParameterType {
  std::string_view name;
  ValueKind kind;
  int group;  ///< Numbers come in multiples of this.
};

constexpr ParameterType kTypes[] = {
    {"integer", ValueKind::kNumbers, 1},
    {"float", ValueKind::kNumbers, 1},
    {"point2", ValueKind::kNumbers, 2},
    {"vector2", ValueKind::kNumbers, 2},
    {"point3", ValueKind::kNumbers, 3},
    {"point", ValueKind::kNumbers, 3},
    {"vector3", ValueKind::kNumbers, 3},
    {"vector", ValueKind::kNumbers, 3},
    {"normal3", ValueKind::kNumbers, 3},
    {"normal", ValueKind::kNumbers, 3},
    {"rgb", ValueKind::kNumbers, 3},
    {"color", ValueKind::kNumbers, 3},
    {"blackbody", ValueKind::kNumbers, 1},
    {"bool", ValueKind::kBools, 1},
    {"string", ValueKind::kStrings, 1},
    {"texture", ValueKind::kStrings, 1},
    {"spectrum", ValueKind::kNumbersOrStrings, 1},
};

const ParameterType* FindType(std::string_view name) {
  const auto* it = std::find_if(std::begin(kTypes), std::end(kTypes),
                                [&](const ParameterType& type) { return type.name == name; });
  return it == std::end(kTypes) ? nullptr : it;
}

std::string Described(const Parameter& parameter) {
  return StrCat("parameter \"", parameter.type, " ", parameter.name, "\"");
}

absl::Status AddString(const Token& token, const SourceLocation& where, Parameter& parameter) {
  STRATA_ASSIGN_OR_RETURN(std::string text, Unescape(token.text, where));
  if (parameter.type == "bool") {
    // Files upgraded from older versions quote the two words.
    if (text != "true" && text != "false") {
      return ErrorAt(where, StrCat(Described(parameter), " must be true or false"));
    }
    parameter.bools.push_back(text == "true");
  } else {
    parameter.strings.push_back(std::move(text));
  }
  return absl::OkStatus();
}

absl::Status AddValue(const Token& token, const SourceLocation& where, ValueKind kind,
                      Parameter& parameter) {
  if (token.kind == Token::Kind::kString) {
    if (kind == ValueKind::kNumbers) {
      return ErrorAt(where, StrCat(Described(parameter), " wants numbers, not strings"));
    }
    return AddString(token, where, parameter);
  }
  if (kind == ValueKind::kBools) {
    if (token.text != "true" && token.text != "false") {
      return ErrorAt(where, StrCat(Described(parameter), " must be true or false"));
    }
    parameter.bools.push_back(token.text == "true");
    return absl::OkStatus();
  }
  if (kind == ValueKind::kStrings) {
    return ErrorAt(where, StrCat(Described(parameter), " wants a string in quotes"));
  }
  absl::StatusOr<double> number = ParseNumber(token.text, where);
  if (!number.ok())
    return absl::Status(number.status().code(),
                        StrCat(number.status().message(), " (", Described(parameter), ")"));
  parameter.numbers.push_back(*number);
  return absl::OkStatus();
}

absl::Status CheckValues(const Parameter& parameter, const ParameterType& type) {
  if (!parameter.numbers.empty() && !parameter.strings.empty()) {
    return ErrorAt(parameter.where, StrCat(Described(parameter), " mixes numbers and strings"));
  }
  if (parameter.numbers.size() % type.group != 0) {
    return ErrorAt(parameter.where, StrCat(Described(parameter), " has ", parameter.numbers.size(),
                                           " numbers, which is no multiple of ", type.group));
  }
  if (type.name == "integer") {
    for (const double number : parameter.numbers) {
      if (number != std::floor(number) || std::fabs(number) > std::numeric_limits<int>::max()) {
        return ErrorAt(parameter.where,
                       StrCat(Described(parameter), " holds ", number, ", which is no integer"));
      }
    }
  }
  return absl::OkStatus();
}

/// `declaration` is the quoted "type name" that starts a parameter.
absl::StatusOr<Parameter> ParseParameter(Tokenizer& tokens, const Token& declaration) {
  Parameter parameter;
  parameter.where = tokens.At(declaration.line);
  const std::vector<std::string> words =
      absl::StrSplit(ToAbsl(declaration.text), absl::ByAnyChar(" \t"), absl::SkipWhitespace());
  const ParameterType* type = words.empty() ? nullptr : FindType(words[0]);
  if (words.size() != 2 || !type) {
    return ErrorAt(parameter.where,
                   StrCat("\"", declaration.text.substr(0, 60),
                          "\" is no parameter; write \"type name\" with a type of pbrt-v4 "
                          "such as \"float\" or \"rgb\""));
  }
  parameter.type = words[0];
  parameter.name = words[1];

  STRATA_ASSIGN_OR_RETURN(Token token, tokens.Next());
  if (token.kind == Token::Kind::kOpen) {
    for (;;) {
      STRATA_ASSIGN_OR_RETURN(token, tokens.Next());
      if (token.kind == Token::Kind::kClose) break;
      if (token.kind == Token::Kind::kEnd || token.kind == Token::Kind::kOpen) {
        return ErrorAt(parameter.where,
                       StrCat("the values of ", Described(parameter), " lack a ]"));
      }
      STRATA_RETURN_IF_ERROR(AddValue(token, tokens.At(token.line), type->kind, parameter));
    }
  } else if (token.kind == Token::Kind::kWord || token.kind == Token::Kind::kString) {
    STRATA_RETURN_IF_ERROR(AddValue(token, tokens.At(token.line), type->kind, parameter));
  }
  STRATA_RETURN_IF_ERROR(CheckValues(parameter, *type));
  return parameter;
}

}  // namespace

absl::StatusOr<std::vector<Parameter>> ParseParameters(Tokenizer& tokens) {
  std::vector<Parameter> parameters;
  for (;;) {
    STRATA_ASSIGN_OR_RETURN(const Token token, tokens.Peek());
    if (token.kind != Token::Kind::kString) return parameters;
    STRATA_RETURN_IF_ERROR(tokens.Next().status());
    STRATA_ASSIGN_OR_RETURN(Parameter parameter, ParseParameter(tokens, token));
    if (parameters.size() >= kMaxParameters) {
      return ErrorAt(parameter.where, "the directive has too many parameters");
    }
    for (const Parameter& other : parameters) {
      if (other.name == parameter.name) {
        return ErrorAt(parameter.where,
                       StrCat("parameter \"", parameter.name, "\" is given twice"));
      }
    }
    parameters.push_back(std::move(parameter));
  }
}

ParameterReader::ParameterReader(std::string directive, SourceLocation where,
                                 std::vector<Parameter> own,
                                 const std::vector<Parameter>& inherited)
    : directive_(std::move(directive)),
      where_(std::move(where)),
      parameters_(std::move(own)),
      own_count_(parameters_.size()) {
  for (const Parameter& parameter : inherited) {
    if (!Find(parameter.name)) parameters_.push_back(parameter);
  }
}

const Parameter* ParameterReader::Find(std::string_view name) const {
  const auto it = std::find_if(parameters_.begin(), parameters_.end(),
                               [&](const Parameter& p) { return p.name == name; });
  return it == parameters_.end() ? nullptr : &*it;
}

const Parameter* ParameterReader::Take(std::string_view name) {
  const Parameter* found = Find(name);
  if (found) parameters_[found - parameters_.data()].used = true;
  return found;
}

void ParameterReader::IgnoreAll() {
  for (Parameter& parameter : parameters_) parameter.used = true;
}

const Parameter* ParameterReader::Typed(std::string_view name,
                                        std::initializer_list<std::string_view> types,
                                        size_t count) {
  const Parameter* parameter = Take(name);
  if (!parameter) return nullptr;
  if (std::find(types.begin(), types.end(), parameter->type) == types.end()) {
    Fail(parameter->where, StrCat(directive_, " wants \"", *types.begin(), " ", name, "\", not \"",
                                  parameter->type, " ", name, "\""));
    return nullptr;
  }
  const size_t given =
      parameter->numbers.size() + parameter->strings.size() + parameter->bools.size();
  if (count != 0 && given != count) {
    Fail(parameter->where, StrCat(directive_, " wants ", count, " value", count == 1 ? "" : "s",
                                  " for \"", name, "\", not ", given));
    return nullptr;
  }
  return parameter;
}

double ParameterReader::Float(std::string_view name, double fallback) {
  const Parameter* p = Typed(name, {"float"}, 1);
  return p ? p->numbers[0] : fallback;
}

int ParameterReader::Integer(std::string_view name, int fallback) {
  const Parameter* p = Typed(name, {"integer"}, 1);
  return p ? static_cast<int>(p->numbers[0]) : fallback;
}

bool ParameterReader::Bool(std::string_view name, bool fallback) {
  const Parameter* p = Typed(name, {"bool"}, 1);
  return p ? p->bools[0] : fallback;
}

std::string ParameterReader::String(std::string_view name, std::string_view fallback) {
  const Parameter* p = Typed(name, {"string"}, 1);
  return p ? p->strings[0] : std::string(fallback);
}

std::optional<Vec3f> ParameterReader::Point3(std::string_view name) {
  const Parameter* p = Typed(name, {"point3", "point", "vector3", "vector"}, 3);
  if (!p) return std::nullopt;
  return Vec3f{static_cast<float>(p->numbers[0]), static_cast<float>(p->numbers[1]),
               static_cast<float>(p->numbers[2])};
}

std::vector<double> ParameterReader::Floats(std::string_view name) {
  const Parameter* p = Typed(name, {"float"}, 0);
  return p ? p->numbers : std::vector<double>();
}

std::vector<int> ParameterReader::Integers(std::string_view name) {
  const Parameter* p = Typed(name, {"integer"}, 0);
  return p ? std::vector<int>(p->numbers.begin(), p->numbers.end()) : std::vector<int>();
}

std::vector<std::string> ParameterReader::Strings(std::string_view name) {
  const Parameter* p = Typed(name, {"string"}, 0);
  return p ? p->strings : std::vector<std::string>();
}

namespace {

std::vector<Vec3f> Triples(const Parameter* parameter) {
  std::vector<Vec3f> triples;
  if (!parameter) return triples;
  const std::vector<double>& n = parameter->numbers;
  triples.reserve(n.size() / 3);
  for (size_t i = 0; i + 2 < n.size(); i += 3) {
    triples.push_back(
        {static_cast<float>(n[i]), static_cast<float>(n[i + 1]), static_cast<float>(n[i + 2])});
  }
  return triples;
}

}  // namespace

std::vector<Vec2f> ParameterReader::Point2s(std::string_view name) {
  std::vector<Vec2f> pairs;
  const Parameter* p = Typed(name, {"point2", "vector2"}, 0);
  if (!p) return pairs;
  pairs.reserve(p->numbers.size() / 2);
  for (size_t i = 0; i + 1 < p->numbers.size(); i += 2) {
    pairs.push_back({static_cast<float>(p->numbers[i]), static_cast<float>(p->numbers[i + 1])});
  }
  return pairs;
}

std::vector<Vec3f> ParameterReader::Point3s(std::string_view name) {
  return Triples(Typed(name, {"point3", "point"}, 0));
}

std::vector<Vec3f> ParameterReader::Normals(std::string_view name) {
  return Triples(Typed(name, {"normal", "normal3"}, 0));
}

absl::Status ParameterReader::Finish(WarningList& warnings) const {
  STRATA_RETURN_IF_ERROR(status_);
  for (size_t i = 0; i < own_count_; ++i) {
    const Parameter& parameter = parameters_[i];
    if (parameter.used) continue;
    warnings.Add(parameter.where,
                 StrCat(directive_, " does not know ", Described(parameter), "; it is ignored"));
  }
  return absl::OkStatus();
}

}  // namespace strata
