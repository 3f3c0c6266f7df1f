#pragma once

#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "worker/gltf/reader.h"

namespace strata {

using Json = nlohmann::json;

/// A folder of files that is removed at the end of a test.
class GltfFolder {
 public:
  GltfFolder() {
    static std::atomic<int> next{0};
    root_ = std::filesystem::temp_directory_path() /
            ("strata-gltf-" + std::to_string(getpid()) + "-" + std::to_string(next++));
    std::filesystem::create_directories(root_);
  }
  ~GltfFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  GltfFolder(const GltfFolder&) = delete;
  GltfFolder& operator=(const GltfFolder&) = delete;

  void Write(const std::string& path, std::string_view text) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path, std::ios::binary) << text;
  }
  absl::StatusOr<SceneFile> Read(const std::string& path = "scene.gltf",
                                 const SceneOptions& options = {}) const {
    return ReadSceneFile(DirectorySource(root_), path, options);
  }
  const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path root_;
};

/// A glTF file in the making: `json` is all of it but for the buffer, which Add fills.
class GltfFile {
 public:
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};

  /// Adds an accessor of what `values` are, type "SCALAR" to "VEC4" or "MAT4"; returns its index.
  template <typename T>
  int Add(const std::vector<T>& values, const std::string& type, int component_type,
          bool normalized = false) {
    const int components = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : type.back() - '0';
    Json accessor = {{"bufferView", AddBytes(values.data(), values.size() * sizeof(T))},
                     {"componentType", component_type},
                     {"count", values.size() / components},
                     {"type", type}};
    if (normalized) accessor["normalized"] = true;
    return Append("accessors", accessor);
  }
  int AddFloats(const std::vector<float>& values, const std::string& type) {
    return Add(values, type, kFloat);
  }
  int AddIndices(const std::vector<uint16_t>& values) {
    return Add(values, "SCALAR", kUnsignedShort);
  }
  /// Returns the buffer view's index.
  int AddBytes(const void* bytes, size_t size) {
    while (buffer_.size() % 4 != 0) buffer_.push_back('\0');
    const size_t offset = buffer_.size();
    buffer_.append(static_cast<const char*>(bytes), size);
    return Append("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", size}});
  }
  /// Returns the index in an array of the file's root.
  int Append(const std::string& array, Json element) {
    json[array].push_back(std::move(element));
    return static_cast<int>(json[array].size()) - 1;
  }
  /// A node of the scene.
  int AddNode(Json node) {
    const int index = Append("nodes", std::move(node));
    json["scenes"][0]["nodes"].push_back(index);
    return index;
  }
  /// A mesh of one primitive: a unit square in the plane z = 0 seen from +z, with the texture
  /// coordinates of an image that stands upright on it.
  int AddSquare(Json primitive = Json::object()) {
    primitive["attributes"]["POSITION"] = AddFloats({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0}, "VEC3");
    primitive["attributes"]["TEXCOORD_0"] = AddFloats({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
    primitive["indices"] = AddIndices({0, 1, 2, 0, 2, 3});
    return Append("meshes", {{"primitives", {primitive}}});
  }

  std::string& buffer() { return buffer_; }

  /// With the buffer in a data URI.
  std::string Text() const {
    Json all = json;
    if (!buffer_.empty())
      all["buffers"] = {{{"byteLength", buffer_.size()},
                         {"uri", "data:application/octet-stream;base64," + Base64(buffer_)}}};
    return all.dump();
  }
  /// With the buffer in the file `uri`.
  std::string TextNaming(const std::string& uri) const {
    Json all = json;
    all["buffers"] = {{{"byteLength", buffer_.size()}, {"uri", uri}}};
    return all.dump();
  }
  std::string Glb() const {
    Json all = json;
    all["buffers"] = {{{"byteLength", buffer_.size()}}};
    std::string text = all.dump(), binary = buffer_;
    while (text.size() % 4 != 0) text += ' ';
    while (binary.size() % 4 != 0) binary += '\0';
    const auto number = [](size_t value) {
      const auto v = static_cast<uint32_t>(value);
      return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    return "glTF" + number(2) + number(28 + text.size() + binary.size()) + number(text.size()) +
           "JSON" + text + number(binary.size()) + std::string("BIN\0", 4) + binary;
  }
  absl::StatusOr<SceneFile> Read(const SceneOptions& options = {}) const {
    GltfFolder folder;
    folder.Write("scene.gltf", Text());
    return folder.Read("scene.gltf", options);
  }

  static constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                       kUnsignedInt = 5125, kFloat = 5126;

  static std::string Base64(std::string_view bytes) {
    static constexpr std::string_view kDigits =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string text;
    for (size_t i = 0; i < bytes.size(); i += 3) {
      uint32_t group = 0;
      for (size_t k = 0; k < 3; ++k)
        group = group << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0);
      for (size_t k = 0; k < 4; ++k)
        text += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63];
    }
    return text;
  }

 private:
  std::string buffer_;
};

/// The only shape's mesh; fails the test where there is another number of shapes.
inline const TriangleMeshShape& OnlyMesh(const SceneFile& file) {
  static const TriangleMeshShape kNone;
  if (file.scene.shapes.size() != 1) return kNone;
  return std::get<TriangleMeshShape>(file.scene.shapes.front().geometry);
}

inline bool Warns(const SceneFile& file, std::string_view element, std::string_view text) {
  for (const SceneWarning& warning : file.warnings) {
    if (warning.where.element.find(element) != std::string::npos &&
        warning.text.find(text) != std::string::npos)
      return true;
  }
  return false;
}

}  // namespace strata
