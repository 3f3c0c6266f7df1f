#include "worker/pbrt/ply.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>

#include "worker/pbrt/ply_header.h"

namespace strata {
namespace {

/// Reads one value after the other from the body. After the first failure all reads give 0.
class PlyBody {
 public:
  PlyBody(std::string_view bytes, const PlyHeader& header)
      : bytes_(bytes), position_(header.body), format_(header.format) {}

  double Read(PlyType type) {
    if (format_ == PlyFormat::kAscii) return ReadAscii();
    const bool swap = format_ == PlyFormat::kBigEndian;
    switch (type) {
      case PlyType::kInt8:
        return static_cast<int8_t>(ReadBits<uint8_t>(swap));
      case PlyType::kUint8:
        return ReadBits<uint8_t>(swap);
      case PlyType::kInt16:
        return static_cast<int16_t>(ReadBits<uint16_t>(swap));
      case PlyType::kUint16:
        return ReadBits<uint16_t>(swap);
      case PlyType::kInt32:
        return static_cast<int32_t>(ReadBits<uint32_t>(swap));
      case PlyType::kUint32:
        return ReadBits<uint32_t>(swap);
      case PlyType::kFloat32:
        return std::bit_cast<float>(ReadBits<uint32_t>(swap));
      case PlyType::kFloat64:
        return std::bit_cast<double>(ReadBits<uint64_t>(swap));
    }
    return 0;
  }

  /// The length of a list whose values are of `type`; fails when the rest of the file is shorter.
  uint64_t ReadLength(PlyType count_type, PlyType type) {
    const double length = Read(count_type);
    const uint64_t least = format_ == PlyFormat::kAscii ? 2 : PlySize(type);
    if (!(length >= 0) || length != std::floor(length) ||
        length > static_cast<double>((bytes_.size() - position_ + 1) / least)) {
      Fail("a list is longer than the rest of the file; the file is truncated or damaged");
      return 0;
    }
    return static_cast<uint64_t>(length);
  }

  bool ok() const { return status_.ok(); }
  const absl::Status& status() const { return status_; }

 private:
  void Fail(std::string_view what) {
    if (!status_.ok()) return;
    status_ = absl::InvalidArgumentError(StrCat(what, " (byte ", position_, ")"));
    position_ = bytes_.size();
  }

  template <typename Bits>
  Bits ReadBits(bool swap) {
    if (bytes_.size() - position_ < sizeof(Bits)) {
      Fail("the file ends early; it is truncated");
      return 0;
    }
    uint8_t raw[sizeof(Bits)];
    std::memcpy(raw, bytes_.data() + position_, sizeof(Bits));
    position_ += sizeof(Bits);
    Bits bits = 0;
    for (size_t i = 0; i < sizeof(Bits); ++i) {
      const size_t byte = swap ? sizeof(Bits) - 1 - i : i;
      bits |= static_cast<Bits>(static_cast<Bits>(raw[byte]) << (8 * i));
    }
    return bits;
  }

  double ReadAscii() {
    const auto is_space = [](char c) { return c == ' ' || c == '\n' || c == '\t' || c == '\r'; };
    while (position_ < bytes_.size() && is_space(bytes_[position_])) ++position_;
    if (position_ >= bytes_.size()) {
      Fail("the file ends early; it is truncated");
      return 0;
    }
    double value = 0;
    const char* begin = bytes_.data() + position_;
    const char* end = bytes_.data() + bytes_.size();
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error == std::errc::invalid_argument || (stop != end && !is_space(*stop))) {
      Fail("a value is no number");
      return 0;
    }
    position_ += stop - begin;
    if (error == std::errc::result_out_of_range) {
      const std::string_view number(begin, stop - begin);
      const bool is_tiny = number.find("e-") != number.npos || number.find("E-") != number.npos;
      return is_tiny ? 0 : std::numeric_limits<double>::infinity();
    }
    return value;
  }

  std::string_view bytes_;
  size_t position_;
  PlyFormat format_;
  absl::Status status_;
};

void Skip(const PlyProperty& property, PlyBody& body) {
  uint64_t values = property.is_list ? body.ReadLength(property.count_type, property.type) : 1;
  for (; values > 0 && body.ok(); --values) body.Read(property.type);
}

/// The places of a vertex that properties fill: x y z, nx ny nz, u v.
constexpr int kVertexSlots = 8;

/// Where a property of a vertex goes; none if it is skipped.
std::optional<int> VertexSlot(const PlyProperty& property) {
  if (property.is_list) return std::nullopt;
  struct Named {
    std::string_view name;
    int slot;
  };
  constexpr Named kNames[] = {{"x", 0},         {"y", 1},        {"z", 2},         {"nx", 3},
                              {"ny", 4},        {"nz", 5},       {"u", 6},         {"v", 7},
                              {"s", 6},         {"t", 7},        {"texture_u", 6}, {"texture_v", 7},
                              {"texture_s", 6}, {"texture_t", 7}};
  for (const Named& named : kNames) {
    if (property.name == named.name) return named.slot;
  }
  return std::nullopt;
}

struct VertexLayout {
  std::vector<std::optional<int>> slots;  ///< Of each property.
  bool has_normals = false, has_uvs = false;
};

absl::StatusOr<VertexLayout> LayOutVertex(const PlyElement& element) {
  VertexLayout layout;
  bool has[kVertexSlots] = {};
  for (const PlyProperty& property : element.properties) {
    const std::optional<int> slot = VertexSlot(property);
    if (slot) has[*slot] = true;
    layout.slots.push_back(slot);
  }
  if (!has[0] || !has[1] || !has[2]) {
    return absl::InvalidArgumentError("the vertices lack one of the properties x, y and z");
  }
  layout.has_normals = has[3] && has[4] && has[5];
  layout.has_uvs = has[6] && has[7];
  return layout;
}

absl::Status ReadVertices(const PlyElement& element, PlyBody& body, TriangleMeshShape& mesh) {
  STRATA_ASSIGN_OR_RETURN(const VertexLayout layout, LayOutVertex(element));
  if (element.count > std::numeric_limits<uint32_t>::max()) {
    return absl::InvalidArgumentError("there are more vertices than a mesh can have (2^32 - 1)");
  }
  mesh.positions.reserve(element.count);
  if (layout.has_normals) mesh.normals.reserve(element.count);
  if (layout.has_uvs) mesh.uvs.reserve(element.count);
  for (uint64_t i = 0; i < element.count; ++i) {
    float values[kVertexSlots] = {};
    bool finite = true;
    for (size_t j = 0; j < layout.slots.size(); ++j) {
      const PlyProperty& property = element.properties[j];
      if (!layout.slots[j]) {
        Skip(property, body);
        continue;
      }
      const double value = body.Read(property.type);
      finite &= std::fabs(value) <= std::numeric_limits<float>::max();
      values[*layout.slots[j]] = static_cast<float>(value);
    }
    STRATA_RETURN_IF_ERROR(body.status());
    if (!finite) {
      return absl::InvalidArgumentError(StrCat("vertex ", i, " has a value that is not finite"));
    }
    mesh.positions.push_back({values[0], values[1], values[2]});
    if (layout.has_normals) mesh.normals.push_back({values[3], values[4], values[5]});
    if (layout.has_uvs) mesh.uvs.push_back({values[6], values[7]});
  }
  return absl::OkStatus();
}

bool IsIndexList(const PlyProperty& property) {
  return property.is_list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

/// Corners are checked against the vertices later, as these may follow in the file.
absl::Status ReadPolygon(uint64_t face, const PlyProperty& property, PlyBody& body,
                         TriangleMeshShape& mesh) {
  const uint64_t corners = body.ReadLength(property.count_type, property.type);
  STRATA_RETURN_IF_ERROR(body.status());
  if (corners < 3) {
    return absl::InvalidArgumentError(
        StrCat("face ", face, " has only ", corners, " corners; it needs at least three"));
  }
  std::array<uint32_t, 3> triangle{};
  for (uint64_t corner = 0; corner < corners; ++corner) {
    const double index = body.Read(property.type);
    STRATA_RETURN_IF_ERROR(body.status());
    if (!(index >= 0) || index != std::floor(index) ||
        index > std::numeric_limits<uint32_t>::max()) {
      return absl::InvalidArgumentError(StrCat("face ", face, " has the vertex index ", index));
    }
    triangle[std::min<uint64_t>(corner, 2)] = static_cast<uint32_t>(index);
    if (corner < 2) continue;
    mesh.triangles.push_back(triangle);
    triangle[1] = triangle[2];
  }
  return absl::OkStatus();
}

absl::Status ReadFaces(const PlyElement& element, PlyBody& body, TriangleMeshShape& mesh) {
  bool has_indices = false;
  for (const PlyProperty& property : element.properties) has_indices |= IsIndexList(property);
  if (!has_indices && element.count > 0) {
    return absl::InvalidArgumentError("the faces lack the list property vertex_indices");
  }
  for (uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (IsIndexList(property)) {
        STRATA_RETURN_IF_ERROR(ReadPolygon(i, property, body, mesh));
      } else {
        Skip(property, body);
        STRATA_RETURN_IF_ERROR(body.status());
      }
    }
  }
  return absl::OkStatus();
}

absl::Status CheckIndices(const TriangleMeshShape& mesh) {
  for (const std::array<uint32_t, 3>& triangle : mesh.triangles) {
    for (const uint32_t index : triangle) {
      if (index >= mesh.positions.size()) {
        return absl::InvalidArgumentError(StrCat("a face has the vertex index ", index,
                                                 ", but there are only ", mesh.positions.size(),
                                                 " vertices"));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<TriangleMeshShape> ParsePly(std::string_view bytes) {
  STRATA_ASSIGN_OR_RETURN(const PlyHeader header, ParsePlyHeader(bytes));
  PlyBody body(bytes, header);
  TriangleMeshShape mesh;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex") {
      STRATA_RETURN_IF_ERROR(ReadVertices(element, body, mesh));
    } else if (element.name == "face") {
      STRATA_RETURN_IF_ERROR(ReadFaces(element, body, mesh));
    } else {
      for (uint64_t i = 0; i < element.count && body.ok(); ++i) {
        for (const PlyProperty& property : element.properties) Skip(property, body);
      }
      STRATA_RETURN_IF_ERROR(body.status());
    }
  }
  STRATA_RETURN_IF_ERROR(CheckIndices(mesh));
  return mesh;
}

}  // namespace strata
