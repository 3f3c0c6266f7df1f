#include <gtest/gtest.h>

#include "tests/gltf/gltf_file.h"

// Vertices, indices and attributes in all the ways glTF can say them.

namespace strata {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

TEST(GltfMesh, ReadsASquareFromTextBinaryAndAFileBeside) {
  GltfFile file;
  file.AddNode({{"mesh", file.AddSquare()}});
  GltfFolder folder;
  folder.Write("scene.gltf", file.Text());
  folder.Write("scene.glb", file.Glb());
  folder.Write("beside.gltf", file.TextNaming("buffers/a%20b.bin"));
  folder.Write("buffers/a b.bin", file.buffer());
  for (const std::string name : {"scene.gltf", "scene.glb", "beside.gltf"}) {
    const auto read = folder.Read(name);
    ASSERT_TRUE(read.ok()) << name << ": " << read.status();
    const TriangleMeshShape& mesh = OnlyMesh(*read);
    EXPECT_EQ(mesh.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
    EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_TRUE(mesh.normals.empty());
    EXPECT_TRUE(mesh.uvs.empty()) << "nothing looks them up";
    const auto files = name == "beside.gltf" ? std::vector<std::string>{name, "buffers/a b.bin"}
                                             : std::vector<std::string>{name};
    std::vector<std::string> sorted = files;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(read->files, sorted);
  }
}

TEST(GltfMesh, StripsAndFansKeepTheirWinding) {
  for (const auto& [mode, expected] : std::vector<std::pair<int, Triangles>>{
           {5, {{0, 1, 2}, {1, 3, 2}, {2, 3, 4}}}, {6, {{1, 2, 0}, {2, 3, 0}, {3, 4, 0}}}}) {
    GltfFile file;
    const Json primitive = {
        {"mode", mode},
        {"attributes",
         {{"POSITION", file.AddFloats({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3")}}}};
    file.AddNode({{"mesh", file.Append("meshes", {{"primitives", {primitive}}})}});
    const auto read = file.Read();
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(OnlyMesh(*read).triangles, expected) << "mode " << mode;
  }
}

TEST(GltfMesh, PointsAndLinesAreLeftOutAndSaidSo) {
  GltfFile file;
  Json points = {{"mode", 0}, {"attributes", {{"POSITION", file.AddFloats({0, 0, 0}, "VEC3")}}}};
  Json lines = points;
  lines["mode"] = 3;
  file.AddNode({{"mesh", file.Append("meshes", {{"primitives", {points, lines}}})}});
  file.AddNode({{"mesh", file.AddSquare()}});
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->scene.shapes.size(), 1u);
  EXPECT_TRUE(Warns(*read, "meshes[0].primitives[0]", "(2 times)"));
}

TEST(GltfMesh, IntegersBecomeNumbers) {
  GltfFile file;
  const int positions = file.Add<int16_t>({-3, 0, 2, 0, 4, 0, 0, 0, 5, 0, 0, 0}, "VEC4", 5122);
  // As three shorts every eight bytes: vertices lie at multiples of four bytes.
  file.json["accessors"][positions]["type"] = "VEC3";
  file.json["bufferViews"][0]["byteStride"] = 8;
  const int normals =
      file.Add<int8_t>({0, 0, 127, 0, 0, -128, 0, 0, 127, 0, 0, 0}, "VEC4", 5120, true);
  file.json["accessors"][normals]["type"] = "VEC3";
  file.json["bufferViews"][1]["byteStride"] = 4;
  const Json primitive = {{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}}};
  file.AddNode({{"mesh", file.Append("meshes", {{"primitives", {primitive}}})}});
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(OnlyMesh(*read).positions, (std::vector<Vec3f>{{-3, 0, 2}, {4, 0, 0}, {5, 0, 0}}));
  EXPECT_EQ(OnlyMesh(*read).normals[0], (Vec3f{0, 0, 1}));
  EXPECT_EQ(OnlyMesh(*read).normals[1], (Vec3f{0, -1, 0}));
}

TEST(GltfMesh, InterleavedVerticesAreTakenApart) {
  GltfFile file;
  const std::vector<float> vertices = {0, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 1, 0, 1, 0, 0};
  const int view = file.AddBytes(vertices.data(), vertices.size() * sizeof(float));
  file.json["bufferViews"][view]["byteStride"] = 24;
  const auto attribute = [&](int offset) {
    return file.Append("accessors", {{"bufferView", view},
                                     {"byteOffset", offset},
                                     {"componentType", 5126},
                                     {"count", 3},
                                     {"type", "VEC3"}});
  };
  const Json primitive = {{"attributes", {{"POSITION", attribute(0)}, {"NORMAL", attribute(12)}}}};
  file.AddNode({{"mesh", file.Append("meshes", {{"primitives", {primitive}}})}});
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(OnlyMesh(*read).positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(OnlyMesh(*read).normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}, {1, 0, 0}}));
}

TEST(GltfMesh, SparseAccessorsReplaceElements) {
  for (const bool with_base : {true, false}) {
    GltfFile file;
    const std::vector<uint8_t> places = {2};
    const std::vector<float> values = {7, 8, 9};
    const Json sparse = {
        {"count", 1},
        {"indices", {{"bufferView", file.AddBytes(places.data(), 1)}, {"componentType", 5121}}},
        {"values", {{"bufferView", file.AddBytes(values.data(), 12)}}}};
    const int positions = file.AddFloats({1, 1, 1, 2, 2, 2, 3, 3, 3}, "VEC3");
    file.json["accessors"][positions]["sparse"] = sparse;
    if (!with_base) file.json["accessors"][positions].erase("bufferView");
    const Json primitive = {{"attributes", {{"POSITION", positions}}}};
    file.AddNode({{"mesh", file.Append("meshes", {{"primitives", {primitive}}})}});
    const auto read = file.Read();
    ASSERT_TRUE(read.ok()) << read.status();
    const float one = with_base ? 1 : 0, two = with_base ? 2 : 0;
    EXPECT_EQ(OnlyMesh(*read).positions,
              (std::vector<Vec3f>{{one, one, one}, {two, two, two}, {7, 8, 9}}));
  }
}

TEST(GltfMesh, ColoursOfAllVerticesAreTheBaseColour) {
  GltfFile file;
  const int colors = file.Add<uint8_t>({255, 0, 51, 255, 0, 51, 255, 0, 51, 255, 0, 51}, "VEC3",
                                       GltfFile::kUnsignedByte, true);
  file.AddNode({{"mesh", file.AddSquare({{"attributes", {{"COLOR_0", colors}}}})}});
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  const auto& material =
      std::get<MetallicRoughnessMaterial>(read->scene.materials[read->scene.shapes[0].material]);
  EXPECT_EQ(std::get<ConstantTexture>(read->scene.textures[material.base_color]).value,
            (Rgb{1, 0, 0.2f}));
}

}  // namespace
}  // namespace strata
