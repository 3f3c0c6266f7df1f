#include "worker/pbrt/ply_header.h"

#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>

#include <optional>

namespace strata {
namespace {

constexpr size_t kMaxHeaderBytes = 1 << 20;

std::optional<PlyType> ParseType(std::string_view name) {
  struct Named {
    std::string_view name;
    PlyType type;
  };
  constexpr Named kTypes[] = {
      {"char", PlyType::kInt8},      {"int8", PlyType::kInt8},       {"uchar", PlyType::kUint8},
      {"uint8", PlyType::kUint8},    {"short", PlyType::kInt16},     {"int16", PlyType::kInt16},
      {"ushort", PlyType::kUint16},  {"uint16", PlyType::kUint16},   {"int", PlyType::kInt32},
      {"int32", PlyType::kInt32},    {"uint", PlyType::kUint32},     {"uint32", PlyType::kUint32},
      {"float", PlyType::kFloat32},  {"float32", PlyType::kFloat32}, {"double", PlyType::kFloat64},
      {"float64", PlyType::kFloat64}};
  for (const Named& named : kTypes) {
    if (named.name == name) return named.type;
  }
  return std::nullopt;
}

absl::Status ParseFormat(const std::vector<std::string>& words, PlyHeader& header) {
  if (words.size() != 3 || words[2] != "1.0") {
    return absl::InvalidArgumentError("the format must be of version 1.0");
  }
  if (words[1] == "ascii") {
    header.format = PlyFormat::kAscii;
  } else if (words[1] == "binary_little_endian") {
    header.format = PlyFormat::kLittleEndian;
  } else if (words[1] == "binary_big_endian") {
    header.format = PlyFormat::kBigEndian;
  } else {
    return absl::InvalidArgumentError(
        "the format must be ascii, binary_little_endian or binary_big_endian");
  }
  return absl::OkStatus();
}

absl::Status ParseElement(const std::vector<std::string>& words, PlyHeader& header) {
  PlyElement element;
  if (words.size() != 3 || !absl::SimpleAtoi(words[2], &element.count)) {
    return absl::InvalidArgumentError("an element wants a name and a count");
  }
  element.name = words[1];
  for (const PlyElement& other : header.elements) {
    if (other.name == element.name) {
      return absl::InvalidArgumentError(StrCat("element \"", element.name, "\" is declared twice"));
    }
  }
  header.elements.push_back(std::move(element));
  return absl::OkStatus();
}

absl::Status ParseProperty(const std::vector<std::string>& words, PlyHeader& header) {
  if (header.elements.empty()) {
    return absl::InvalidArgumentError("a property stands before any element");
  }
  PlyProperty property;
  property.is_list = words.size() > 1 && words[1] == "list";
  if (words.size() != (property.is_list ? 5 : 3)) {
    return absl::InvalidArgumentError("a property wants a type and a name");
  }
  const std::optional<PlyType> type = ParseType(words[property.is_list ? 3 : 1]);
  const std::optional<PlyType> count_type =
      property.is_list ? ParseType(words[2]) : PlyType::kUint8;
  if (!type || !count_type) return absl::InvalidArgumentError("a property has an unknown type");
  if (*count_type == PlyType::kFloat32 || *count_type == PlyType::kFloat64) {
    return absl::InvalidArgumentError("a list's length must be an integer");
  }
  property.type = *type;
  property.count_type = *count_type;
  property.name = words.back();
  for (const PlyProperty& other : header.elements.back().properties) {
    if (other.name == property.name) {
      return absl::InvalidArgumentError(
          StrCat("property \"", property.name, "\" is declared twice"));
    }
  }
  header.elements.back().properties.push_back(std::move(property));
  return absl::OkStatus();
}

absl::Status ParseLine(std::string_view line, PlyHeader& header, bool& has_format, bool& ended) {
  const std::vector<std::string> words =
      absl::StrSplit(ToAbsl(line), absl::ByAnyChar(" \t"), absl::SkipWhitespace());
  if (words.empty() || words[0] == "comment" || words[0] == "obj_info") return absl::OkStatus();
  if (words[0] == "format") {
    if (has_format) return absl::InvalidArgumentError("the format is given twice");
    has_format = true;
    return ParseFormat(words, header);
  }
  if (words[0] == "element") return ParseElement(words, header);
  if (words[0] == "property") return ParseProperty(words, header);
  if (words[0] == "end_header") {
    ended = true;
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      StrCat("unknown keyword \"", absl::string_view(words[0]).substr(0, 40), "\""));
}

/// Each element takes at least so many bytes; 0 when it has no properties.
uint64_t LeastBytes(const PlyElement& element, PlyFormat format) {
  if (format == PlyFormat::kAscii) return 2 * element.properties.size();  // a digit and a space
  uint64_t bytes = 0;
  for (const PlyProperty& property : element.properties) {
    bytes += PlySize(property.is_list ? property.count_type : property.type);
  }
  return bytes;
}

absl::Status CheckCounts(const PlyHeader& header, uint64_t body_bytes) {
  for (const PlyElement& element : header.elements) {
    const uint64_t least = LeastBytes(element, header.format);
    if (least == 0) {
      if (element.count == 0) continue;
      return absl::InvalidArgumentError(StrCat("element \"", element.name, "\" has no properties"));
    }
    // The last value of an ASCII file needs no white space after it.
    if (element.count > (body_bytes + 1) / least) {
      return absl::InvalidArgumentError(StrCat(
          "the header announces ", element.count, " of element \"", element.name, "\", but only ",
          body_bytes, " bytes follow; the file is truncated or its counts are wrong"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

int PlySize(PlyType type) {
  switch (type) {
    case PlyType::kInt8:
    case PlyType::kUint8:
      return 1;
    case PlyType::kInt16:
    case PlyType::kUint16:
      return 2;
    case PlyType::kInt32:
    case PlyType::kUint32:
    case PlyType::kFloat32:
      return 4;
    case PlyType::kFloat64:
      return 8;
  }
  return 8;
}

absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes) {
  PlyHeader header;
  bool has_format = false, ended = false;
  size_t position = 0;
  for (int line_number = 1; !ended; ++line_number) {
    const size_t end = bytes.find('\n', position);
    if (end == std::string_view::npos || end > kMaxHeaderBytes) {
      return absl::InvalidArgumentError(line_number == 1 ? "this is no PLY file"
                                                         : "the header has no end_header");
    }
    std::string_view line = bytes.substr(position, end - position);
    if (line.ends_with('\r')) line.remove_suffix(1);
    position = end + 1;
    if (line_number == 1) {
      if (line != "ply") return absl::InvalidArgumentError("this is no PLY file");
      continue;
    }
    const absl::Status status = ParseLine(line, header, has_format, ended);
    if (!status.ok()) return Annotate(status, StrCat("header line ", line_number));
  }
  if (!has_format) return absl::InvalidArgumentError("the header names no format");
  header.body = position;
  STRATA_RETURN_IF_ERROR(CheckCounts(header, bytes.size() - position));
  return header;
}

}  // namespace strata
