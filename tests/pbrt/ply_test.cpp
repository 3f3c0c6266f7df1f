#include "worker/pbrt/ply.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/pbrt/ply_bytes.h"
#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

using Triangle = std::array<uint32_t, 3>;

constexpr PlyLayout kLayouts[] = {PlyLayout::kAscii, PlyLayout::kLittleEndian,
                                  PlyLayout::kBigEndian};

/// An ASCII file of three vertices with one thing replaced.
std::string Ascii(const std::string& from = "", const std::string& to = "") {
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  if (!from.empty()) ply.replace(ply.find(from), from.size(), to);
  return ply;
}

TEST(Ply, IsReadInAllThreeFormats) {
  for (const PlyLayout layout : kLayouts) {
    const absl::StatusOr<TriangleMeshShape> mesh = ParsePly(SquarePly(layout));
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    ASSERT_EQ(mesh->positions.size(), 5u);
    EXPECT_EQ(mesh->positions[2], (Vec3f{1, 1, 0}));
    EXPECT_EQ(mesh->positions[4], (Vec3f{0, 0, 2}));
    ASSERT_EQ(mesh->normals.size(), 5u);
    EXPECT_EQ(mesh->normals[3], (Vec3f{0, 0, 1}));
    ASSERT_EQ(mesh->uvs.size(), 5u);
    EXPECT_EQ(mesh->uvs[2].x, 1);
    EXPECT_EQ(mesh->uvs[1].y, 0);
    // The quad becomes a fan.
    EXPECT_EQ(mesh->triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {0, 1, 4}}));
  }
}

TEST(Ply, FacesMayComeFirstAndLinesMayEndAsOnOtherSystems) {
  std::string ply =
      "ply\r\nformat ascii 1.0\r\nelement face 1\r\nproperty list uint8 uint32 vertex_index\r\n"
      "element vertex 3\r\nproperty float32 x\r\nproperty float32 y\r\nproperty float32 z\r\n"
      "end_header\r\n3 0 1 2\r\n0 0 0\r\n1 0 0\r\n0 1 0";
  const absl::StatusOr<TriangleMeshShape> mesh = ParsePly(ply);
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_TRUE(mesh->normals.empty());
}

TEST(Ply, TruncatedAnywhereIsTold) {
  for (const PlyLayout layout : kLayouts) {
    const std::string ply = SquarePly(layout);
    // The last value of the ASCII file is a single digit and a space.
    const size_t whole = layout == PlyLayout::kAscii ? ply.size() - 2 : ply.size() - 1;
    for (size_t length = 0; length <= whole; ++length) {
      const absl::Status status = ParsePly(std::string_view(ply).substr(0, length)).status();
      ASSERT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << length;
      ASSERT_FALSE(status.message().empty());
    }
    EXPECT_TRUE(ParsePly(ply).ok());
  }
}

struct Malformation {
  std::string from, to, phrase;
};

TEST(Ply, MalformationsAreTold) {
  const Malformation cases[] = {
      {"ply\n", "pli\n", "no PLY file"},
      {"ascii", "utf8", "format must be"},
      {"1.0", "2.0", "version 1.0"},
      {"format ascii 1.0\n", "", "no format"},
      {"format ascii 1.0\n", "format ascii 1.0\nformat ascii 1.0\n", "header line 3"},
      {"element vertex 3", "element vertex", "a name and a count"},
      {"element vertex 3", "element vertex -3", "a name and a count"},
      {"element vertex 3", "element vertex many", "a name and a count"},
      {"element vertex 3\n", "", "before any element"},
      {"element face 1", "element vertex 1", "declared twice"},
      {"property float y", "property float x", "declared twice"},
      {"property float y", "property half y", "unknown type"},
      {"property float y", "property float", "a type and a name"},
      {"property list uchar int vertex_indices", "property list float int vertex_indices",
       "must be an integer"},
      {"property list uchar int vertex_indices", "property list uchar int corners",
       "vertex_indices"},
      {"property float z\n", "", "x, y and z"},
      {"property float x\n", "properly float x\n", "unknown keyword"},
      {"end_header\n", "", "unknown keyword"},
      {"end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "", "no end_header"},
      {"element vertex 3", "element vertex 4000000000", "truncated"},
      {"element vertex 3", "element vertex 18446744073709551615", "truncated"},
      {"element face 1", "element face 9999999999", "truncated"},
      {"element vertex 3", "element vertex 4", "longer than the rest"},
      {"element vertex 3", "element vertex 2", "corners"},
      {"element face 1\nproperty list uchar int vertex_indices", "element face 1", "no properties"},
      {"1 0 0", "1 nan 0", "vertex 1 has a value that is not finite"},
      {"1 0 0", "1 inf 0", "not finite"},
      {"1 0 0", "1 1e300 0", "not finite"},
      {"1 0 0", "1 1e999 0", "not finite"},
      {"1 0 0", "1 x 0", "no number"},
      {"1 0 0", "1 0x 0", "no number"},
      {"3 0 1 2", "3 0 1 3", "vertex index 3"},
      {"3 0 1 2", "3 0 1 -1", "vertex index -1"},
      {"3 0 1 2", "3 0 1 0.5", "vertex index 0.5"},
      {"3 0 1 2", "3 0 1 4294967296", "vertex index 4.2"},
      {"3 0 1 2", "3 0 1", "ends early"},
      {"3 0 1 2", "2 0 1", "only 2 corners"},
      {"3 0 1 2", "0", "only 0 corners"},
      {"3 0 1 2", "-3 0 1 2", "longer than the rest"},
      {"3 0 1 2", "2.5 0 1 2", "longer than the rest"},
      {"3 0 1 2", "255 0 1 2", "longer than the rest"},
  };
  ASSERT_TRUE(ParsePly(Ascii()).ok());
  for (const Malformation& c : cases) {
    const absl::Status status = ParsePly(Ascii(c.from, c.to)).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << c.from << " -> " << c.to;
    EXPECT_NE(std::string(status.message()).find(c.phrase), std::string::npos)
        << c.from << " -> " << c.to << ": " << status;
  }
}

TEST(Ply, AListThatClaimsGigabytesIsToldBeforeItIsRead) {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nproperty list uint double w\nend_header\n";
  ply += std::string(12, '\0') + "\xff\xff\xff\xff";
  const absl::Status status = ParsePly(ply).status();
  EXPECT_NE(std::string(status.message()).find("longer than the rest"), std::string::npos)
      << status;
}

TEST(Ply, ErrorsNameTheShapeAndTheFile) {
  SceneFolder folder;
  folder.Write("scene.pbrt", "WorldBegin\n\nShape \"plymesh\" \"string filename\" \"bad.ply\"");
  folder.Write("bad.ply", Ascii("1 0 0", "1 nan 0"));
  const std::string message(folder.Read().status().message());
  EXPECT_EQ(message.find("scene.pbrt:3: \"bad.ply\": vertex 1"), 0u) << message;
}

TEST(Ply, WithoutFacesIsLeftOutWithAWarning) {
  SceneFolder folder;
  folder.Write("scene.pbrt", "WorldBegin Shape \"plymesh\" \"string filename\" \"a.ply\"");
  folder.Write("a.ply",
               "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_TRUE(scene->scene.shapes.empty());
  EXPECT_EQ(scene->warnings.size(), 1u);
}

}  // namespace
}  // namespace strata
