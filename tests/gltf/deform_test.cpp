#include <gtest/gtest.h>

#include <cmath>

#include "tests/gltf/gltf_file.h"

// Skins, morph targets and animations: the rest pose.

namespace strata {
namespace {

void ExpectNear(Vec3f a, Vec3f b) {
  EXPECT_LT(Length(a - b), 1e-6f) << a.x << " " << a.y << " " << a.z;
}

/// A square whose lower edge follows a joint at the origin and whose upper edge one that stands at
/// (0, 1, 0), where it was bound, and is turned by a quarter about z. `weights`: of the four
/// vertices, four each.
struct Skinned {
  GltfFile file;
  int mesh = 0, skin = 0, node = 0;

  explicit Skinned(const std::vector<float>& weights) {
    const int joints = file.Add<uint8_t>({0, 1, 9, 9, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}, "VEC4",
                                         GltfFile::kUnsignedByte);
    const int normals = file.AddFloats({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
    mesh = file.AddSquare({{"attributes",
                            {{"NORMAL", normals},
                             {"JOINTS_0", joints},
                             {"WEIGHTS_0", file.AddFloats(weights, "VEC4")}}}});
    const int matrices = file.AddFloats({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0,  0, 1,
                                         1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -1, 0, 1},
                                        "MAT4");
    // The skinned node comes before its joints, and its transform must not count.
    node = file.AddNode({{"mesh", mesh}, {"skin", 0}, {"translation", {50, 60, 70}}});
    const double half = std::sqrt(0.5);
    const int upper =
        file.Append("nodes", {{"translation", {0, 1, 0}}, {"rotation", {0, 0, half, half}}});
    const int lower = file.AddNode({{"children", {upper}}});
    skin = file.Append("skins", {{"joints", {lower, upper}}, {"inverseBindMatrices", matrices}});
  }
};

const std::vector<float> kEdges = {1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0};

TEST(GltfSkin, VerticesFollowTheirJointsAndNotTheirNode) {
  const auto read = Skinned(kEdges).file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->scene.shapes.size(), 1u);
  EXPECT_EQ(read->scene.shapes[0].to_world, Transform{});
  const TriangleMeshShape& mesh = OnlyMesh(*read);
  ExpectNear(mesh.positions[0], {0, 0, 0});
  ExpectNear(mesh.positions[1], {1, 0, 0});
  // (1, 1, 0) is (1, 0, 0) of the joint, which a quarter turn takes to (0, 1, 0).
  ExpectNear(mesh.positions[2], {0, 2, 0});
  ExpectNear(mesh.positions[3], {0, 1, 0});
  ExpectNear(mesh.normals[0], {1, 0, 0});
  ExpectNear(mesh.normals[2], {0, 1, 0});
  for (const SceneWarning& warning : read->warnings)
    EXPECT_EQ(warning.text.find("left out"), std::string::npos) << warning.text;
}

TEST(GltfSkin, WithoutMatricesIsThatOfIdentities) {
  Skinned skinned(kEdges);
  skinned.file.json["skins"][0].erase("inverseBindMatrices");
  const auto read = skinned.file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_FALSE(Warns(*read, "", "inverseBindMatrices"));
  const TriangleMeshShape& mesh = OnlyMesh(*read);
  // The upper joint, which they had moved to the origin, stays where it is.
  ExpectNear(mesh.positions[0], {0, 0, 0});
  ExpectNear(mesh.positions[2], {-1, 2, 0});
}

TEST(GltfSkin, WeightsBlendMatricesAndNeedNotSumToOne) {
  for (const float sum : {1.0f, 2.0f}) {
    std::vector<float> weights = kEdges;
    weights[8] = weights[9] = sum / 2;  // Vertex 2.
    const auto read = Skinned(weights).file.Read();
    ASSERT_TRUE(read.ok()) << read.status();
    ExpectNear(OnlyMesh(*read).positions[2], {0.5f, 1.5f, 0});
    const float half = std::sqrt(0.5f);
    ExpectNear(OnlyMesh(*read).normals[2], {half, half, 0});
  }
}

TEST(GltfSkin, LiesAreRefusedWithTheirPlace) {
  const auto error = [](auto change) {
    Skinned skinned(kEdges);
    change(skinned.file.json);
    return std::string(skinned.file.Read().status().message());
  };
  const auto expect = [](const std::string& message, const std::string& part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  expect(error([](Json& j) { j["nodes"][0]["skin"] = 4; }), "nodes[0].skin: there is no skin 4");
  expect(error([](Json& j) { j["skins"][0]["joints"] = {2}; }), "names joint 1 of 1");
  expect(error([](Json& j) { j["skins"][0]["joints"] = {2, 1, 2}; }), "2 of 3 matrices");
  expect(error([](Json& j) { j["skins"][0]["joints"][1] = 7; }), "there is no node 7");
  expect(error([](Json& j) { j["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); }),
         "WEIGHTS_0: it is missing");
}

TEST(GltfSkin, WithAJointOutOfTheSceneIsLeftOutAndSaidSo) {
  Skinned skinned(kEdges);
  skinned.file.json["nodes"][2].erase("children");
  const auto read = skinned.file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(Warns(*read, "skins[0]", "nodes[1] is not in the scene"));
  EXPECT_EQ(read->scene.shapes.at(0).to_world.Point({0, 0, 0}), (Vec3d{50, 60, 70}));
}

/// A square with two targets: all up by 1 with the normal turned to x, and all to the right by 1.
GltfFile Morphing() {
  GltfFile file;
  const int normals = file.AddFloats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int up = file.AddFloats({0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0}, "VEC3");
  const int turn = file.AddFloats({1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}, "VEC3");
  const Json targets = {{{"POSITION", up}, {"NORMAL", turn}}, {{"POSITION", turn}}};
  file.AddSquare({{"attributes", {{"NORMAL", normals}}}, {"targets", targets}});
  file.AddNode({{"mesh", 0}});
  return file;
}

TEST(GltfMorph, WeightsOfTheMeshAreTheDefault) {
  GltfFile file = Morphing();
  const auto at_rest = file.Read();
  ASSERT_TRUE(at_rest.ok()) << at_rest.status();
  ExpectNear(OnlyMesh(*at_rest).positions[1], {1, 0, 0});
  file.json["meshes"][0]["weights"] = {0.5, 2};
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  ExpectNear(OnlyMesh(*read).positions[1], {3, 0.5f, 0});
  ExpectNear(OnlyMesh(*read).normals[1], {0.5f, 0, 1});
}

TEST(GltfMorph, WeightsOfANodeAreItsOwn) {
  GltfFile file = Morphing();
  file.json["meshes"][0]["weights"] = {1, 0};
  file.AddNode({{"mesh", 0}, {"weights", {0, 1}}});
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  ASSERT_EQ(read->scene.shapes.size(), 2u);
  std::vector<Vec3f> seen;
  for (const ShapeDescription& shape : read->scene.shapes)
    seen.push_back(std::get<TriangleMeshShape>(shape.geometry).positions[0]);
  ExpectNear(seen[0], {1, 0, 0});
  ExpectNear(seen[1], {0, 1, 0});
}

TEST(GltfAnimation, IsNotPlayedAndSaidSoOnce) {
  GltfFile file = Morphing();
  const int times = file.AddFloats({0, 1}, "SCALAR");
  const int values = file.AddFloats({5, 5, 5, 6, 6, 6}, "VEC3");
  file.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", values}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  file.json["animations"].push_back(file.json["animations"][0]);
  file.json["nodes"][0]["translation"] = {1, 2, 3};
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->scene.shapes.at(0).to_world.Point({0, 0, 0}), (Vec3d{1, 2, 3}));
  size_t told = 0;
  for (const SceneWarning& warning : read->warnings)
    told += warning.text.find("rest pose") != std::string::npos;
  EXPECT_EQ(told, 1u);
}

}  // namespace
}  // namespace strata
