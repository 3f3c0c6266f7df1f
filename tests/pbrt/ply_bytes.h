#pragma once

#include <cstdint>
#include <cstring>
#include <string>

namespace strata {

enum class PlyLayout { kAscii, kLittleEndian, kBigEndian };

/// A value as the body of a PLY file of `layout` holds it.
template <typename T>
std::string PlyValue(T value, PlyLayout layout) {
  if (layout == PlyLayout::kAscii) return std::to_string(value) + " ";
  std::string bytes(sizeof(T), '\0');
  std::memcpy(bytes.data(), &value, sizeof(T));  // the tests run on little-endian machines
  return layout == PlyLayout::kLittleEndian ? bytes : std::string(bytes.rbegin(), bytes.rend());
}

/// A unit square as one quad, and a triangle above it, with normals, uv and things to skip.
inline std::string SquarePly(PlyLayout layout) {
  const char* format = layout == PlyLayout::kAscii          ? "ascii"
                       : layout == PlyLayout::kLittleEndian ? "binary_little_endian"
                                                            : "binary_big_endian";
  std::string ply = std::string("ply\nformat ") + format +
                    " 1.0\ncomment of no interest\n"
                    "element camera 1\nproperty short id\nproperty list uchar double knots\n"
                    "element vertex 5\nproperty float x\nproperty double y\nproperty float z\n"
                    "property uchar red\nproperty float nx\nproperty float ny\nproperty float nz\n"
                    "property float s\nproperty float t\n"
                    "element face 2\nproperty list uchar int vertex_indices\n"
                    "property int face_indices\nend_header\n";
  ply += PlyValue<int16_t>(-2, layout) + PlyValue<uint8_t>(2, layout);
  ply += PlyValue<double>(0.5, layout) + PlyValue<double>(1.5, layout);
  const float positions[5][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 2}};
  for (const auto& p : positions) {
    ply += PlyValue<float>(p[0], layout) + PlyValue<double>(p[1], layout);
    ply += PlyValue<float>(p[2], layout) + PlyValue<uint8_t>(255, layout);
    for (const float n : {0.0f, 0.0f, 1.0f}) ply += PlyValue<float>(n, layout);
    ply += PlyValue<float>(p[0], layout) + PlyValue<float>(p[1], layout);
  }
  ply += PlyValue<uint8_t>(4, layout);
  for (const int32_t i : {0, 1, 2, 3}) ply += PlyValue<int32_t>(i, layout);
  ply += PlyValue<int32_t>(7, layout);
  ply += PlyValue<uint8_t>(3, layout);
  for (const int32_t i : {0, 1, 4}) ply += PlyValue<int32_t>(i, layout);
  ply += PlyValue<int32_t>(8, layout);
  return ply;
}

}  // namespace strata
