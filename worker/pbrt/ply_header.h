#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/status.h"
#include "common/text.h"

namespace strata {

enum class PlyType { kInt8, kUint8, kInt16, kUint16, kInt32, kUint32, kFloat32, kFloat64 };
enum class PlyFormat { kAscii, kLittleEndian, kBigEndian };

/// Bytes of a value in a binary file.
int PlySize(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::kFloat32;
  bool is_list = false;
  PlyType count_type = PlyType::kUint8;  ///< Of a list's length.
};

struct PlyElement {
  std::string name;
  uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::kAscii;
  std::vector<PlyElement> elements;
  size_t body = 0;  ///< Offset of the first byte after the header.
};

/// INVALID_ARGUMENT with the header's line when it is malformed, or when an element's count cannot
/// be held by the bytes that follow.
absl::StatusOr<PlyHeader> ParsePlyHeader(std::string_view bytes);

}  // namespace strata
