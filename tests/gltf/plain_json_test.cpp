#include <gtest/gtest.h>

#include "tests/gltf/gltf_file.h"

// What the specification allows and few files do: numbers, URIs and buffers in other words.

namespace strata {
namespace {

GltfFile Square() {
  GltfFile file;
  file.AddNode({{"mesh", file.AddSquare({{"material", 0}})}});
  file.Append("materials", {{"pbrMetallicRoughness", {{"roughnessFactor", 0.5}}}});
  return file;
}

void ExpectSquare(const absl::StatusOr<SceneFile>& read, const std::string& what) {
  ASSERT_TRUE(read.ok()) << what << ": " << read.status();
  const TriangleMeshShape& mesh = OnlyMesh(*read);
  EXPECT_EQ(mesh.positions.size(), 4u) << what;
  EXPECT_EQ(mesh.triangles.size(), 2u) << what;
  EXPECT_FALSE(Warns(*read, "", "left out")) << what;
}

Json WithFractions(Json json) {
  if (json.is_structured()) {
    for (Json& value : json) value = WithFractions(value);
  } else if (json.is_number_integer()) {
    json = json.get<double>();
  }
  return json;
}

TEST(GltfPlainJson, IntegersMayHaveAFractionOfZero) {
  GltfFile file = Square();
  ExpectSquare(file.Read(), "integers");
  const std::string text = WithFractions(Json::parse(file.Text())).dump();
  ASSERT_NE(text.find("\"count\":4.0"), std::string::npos);
  const GltfFolder folder;
  folder.Write("scene.gltf", text);
  ExpectSquare(folder.Read(), "fractions");
  file.json = WithFractions(file.json);
  folder.Write("scene.glb", file.Glb());
  ExpectSquare(folder.Read("scene.glb"), "fractions in a .glb");
  // Where there is a fraction there is no index.
  file.json["nodes"][0]["mesh"] = 0.5;
  folder.Write("scene.gltf", file.Text());
  const auto read = folder.Read();
  EXPECT_TRUE(!read.ok() || read->scene.shapes.empty());
}

TEST(GltfPlainJson, BuffersAreTheBeginningsOfFilesOfAnyName) {
  GltfFile file = Square();
  for (const auto& [name, uri] :
       std::vector<std::pair<std::string, std::string>>{{"a.bin", "a.bin"},
                                                        {"a+b.bin", "a+b.bin"},
                                                        {"a b.bin", "a%20b.bin"},
                                                        {"a%zz.bin", "a%zz.bin"},
                                                        {"a+c.bin", "a%2Bc.bin"}}) {
    const GltfFolder folder;
    folder.Write(name, file.buffer() + "and more");
    folder.Write("scene.gltf", file.TextNaming(uri));
    ExpectSquare(folder.Read(), uri);
    folder.Write(name, file.buffer().substr(1));
    EXPECT_FALSE(folder.Read().ok()) << uri << ", a byte short";
  }
}

TEST(GltfPlainJson, DataUrisAreOfAnyMediaType) {
  GltfFile file = Square();
  const GltfFolder folder;
  const auto read = [&](const std::string& uri) {
    folder.Write("scene.gltf", file.TextNaming(uri));
    return folder.Read();
  };
  std::string payload = GltfFile::Base64(file.buffer());
  for (const char* type : {"", "application/x-unheard-of", "text/plain;charset=utf-8"})
    ExpectSquare(read("data:" + std::string(type) + ";base64," + payload), type);
  std::string escaped;
  for (const char c : payload)
    escaped += c == '+' ? "%2B" : c == '/' ? "%2f" : c == '=' ? "%3D" : std::string(1, c);
  ExpectSquare(read("data:;base64," + escaped), "escapes");
  const std::string message(read("data:," + std::string(100000, 'x')).status().message());
  EXPECT_NE(message.find("scene.gltf:buffers[0].uri: its data URI is not in base64"),
            std::string::npos)
      << message.substr(0, 200);
  EXPECT_LT(message.size(), 200u);
}

TEST(GltfPlainJson, FilesThatNeedALaterVersionAreRefused) {
  GltfFile file = Square();
  file.json["asset"]["minVersion"] = "2.0";
  ExpectSquare(file.Read(), "2.0");
  file.json["asset"]["minVersion"] = "2.7";
  EXPECT_NE(file.Read().status().message().find("asset.minVersion: the file needs glTF 2.7"),
            std::string::npos);
}

TEST(GltfPlainJson, MatricesOfNodesMayBeRounded) {
  GltfFile file = Square();
  Json& matrix = file.json["nodes"][0]["matrix"];
  matrix = {1, 0, 0, 0, 0, 1, 0, 1e-9, 0, 0, 1, 0, 0, 0, 0, 1.0000001};
  ExpectSquare(file.Read(), "rounded");
  EXPECT_EQ(file.Read()->scene.shapes[0].to_world, Transform{});
  matrix[15] = 1.01;
  EXPECT_FALSE(file.Read().ok());
}

}  // namespace
}  // namespace strata
