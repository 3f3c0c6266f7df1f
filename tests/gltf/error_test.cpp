#include <gtest/gtest.h>

#include <random>

#include "tests/gltf/gltf_file.h"
#include "worker/scene/scene.h"

// Files that are wrong: one sentence that says where, and never a crash.

namespace strata {
namespace {

/// The error of a sound file of one square after `change`; fails the test where there is none.
template <typename Change>
std::string ErrorAfter(Change change) {
  GltfFile file;
  file.AddNode({{"mesh", file.AddSquare()}});
  EXPECT_TRUE(file.Read().ok()) << file.Read().status();
  change(file.json);
  const absl::Status status = file.Read().status();
  EXPECT_FALSE(status.ok());
  const std::string message(status.message());
  EXPECT_EQ(message.find("scene.gltf:"), 0u) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  return message;
}
template <typename Change>
void ExpectError(const std::string& where, Change change) {
  const std::string message = ErrorAfter(change);
  EXPECT_NE(message.find(where), std::string::npos) << message << "\nexpected " << where;
}

TEST(GltfErrors, NameTheElement) {
  ExpectError("scene.gltf:accessors[0]: its 5 elements",
              [](Json& j) { j["accessors"][0]["count"] = 5; });
  ExpectError("accessors[0]", [](Json& j) { j["accessors"][0]["byteOffset"] = 4; });
  ExpectError("accessors[0]", [](Json& j) { j["accessors"][0]["count"] = 4611686018427387904ull; });
  ExpectError("accessors[0]", [](Json& j) { j["accessors"][0]["componentType"] = 5130; });
  ExpectError("accessors[0]", [](Json& j) { j["accessors"][0]["type"] = "VEC2"; });
  ExpectError("accessors[0]", [](Json& j) {
    j["accessors"][0].erase("bufferView"), j["accessors"][0]["count"] = 1 << 30;
  });
  ExpectError("bufferViews[0]", [](Json& j) { j["bufferViews"][0]["byteLength"] = 4000; });
  ExpectError("accessors[0]", [](Json& j) { j["bufferViews"][0]["byteStride"] = 8; });
  ExpectError("bufferViews[0]", [](Json& j) { j["bufferViews"][0]["buffer"] = 3; });
  ExpectError("indices: it names vertex 2",
              [](Json& j) { j["accessors"][0]["count"] = 2, j["accessors"][1]["count"] = 2; });
  ExpectError("TEXCOORD_0: it has 3 elements", [](Json& j) {
    j["accessors"][1]["count"] = 3;
    j["materials"] = {{{"normalTexture", {{"index", 0}}}}};
    j["meshes"][0]["primitives"][0]["material"] = 0;
  });
  ExpectError("there is no mesh 4", [](Json& j) { j["nodes"][0]["mesh"] = 4; });
  ExpectError("there is no material 1",
              [](Json& j) { j["meshes"][0]["primitives"][0]["material"] = 1; });
  ExpectError("there is no texture 7", [](Json& j) {
    j["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 7}}}}}}};
    j["meshes"][0]["primitives"][0]["material"] = 0;
  });
  ExpectError("KHR_materials_ior.ior", [](Json& j) {
    j["materials"] = {{{"extensions", {{"KHR_materials_ior", {{"ior", "1.5"}}}}}}};
    j["meshes"][0]["primitives"][0]["material"] = 0;
  });
  ExpectError("nodes[0].rotation", [](Json& j) { j["nodes"][0]["rotation"] = {0, 0, 0, 0}; });
  ExpectError("nodes[0].matrix", [](Json& j) { j["nodes"][0]["matrix"] = {1, 2, 3}; });
  ExpectError("there is no node 9", [](Json& j) { j["scenes"][0]["nodes"] = {9}; });
  ExpectError("asset.version", [](Json& j) { j["asset"]["version"] = "1.0"; });
}

TEST(GltfErrors, FactorsOfMaterialsHaveTheirTypesAndRanges) {
  const auto expect = [](const std::string& where, Json material) {
    ExpectError("scene.gltf:materials[0]." + where,
                [&](Json& j) { j["materials"] = {std::move(material)}; });
  };
  const auto pbr = [](Json factors) { return Json{{"pbrMetallicRoughness", std::move(factors)}}; };
  expect("pbrMetallicRoughness.roughnessFactor: it must be a number",
         pbr({{"roughnessFactor", "x"}}));
  expect("pbrMetallicRoughness.metallicFactor: it must be a number within 0 and 1",
         pbr({{"metallicFactor", 2}}));
  expect("pbrMetallicRoughness.metallicFactor", pbr({{"metallicFactor", nullptr}}));
  expect("pbrMetallicRoughness.baseColorFactor: it must be 4 numbers",
         pbr({{"baseColorFactor", {1, 1, 1}}}));
  expect("emissiveFactor: it must be 3 numbers not below 0", {{"emissiveFactor", {0, 0, "a"}}});
  expect("alphaCutoff", {{"alphaCutoff", "x"}});
  expect("alphaMode: it must be OPAQUE, MASK or BLEND", {{"alphaMode", "FOO"}});
  expect("doubleSided", {{"doubleSided", 1}});
}

TEST(GltfErrors, RequiredExtensionsAreRefusedInASentence) {
  for (const auto& [name, remedy] : std::vector<std::pair<std::string, std::string>>{
           {"KHR_draco_mesh_compression", "uncompressed"},
           {"EXT_meshopt_compression", "uncompressed"},
           {"KHR_texture_basisu", "PNG"},
           {"EXT_texture_webp", "PNG"},
           {"KHR_unheard_of", "without"}}) {
    const std::string message = ErrorAfter([&](Json& j) { j["extensionsRequired"] = {name}; });
    EXPECT_NE(message.find(name), std::string::npos) << message;
    EXPECT_NE(message.find(remedy), std::string::npos) << message;
  }
}

TEST(GltfErrors, CompressedDataAreNamedAndNotTheBuffersTheyLeaveEmpty) {
  GltfFolder folder;
  folder.Write("scene.gltf",
               R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4}],
                   "extensionsRequired": ["EXT_meshopt_compression"]})");
  const std::string required(folder.Read().status().message());
  EXPECT_NE(required.find("EXT_meshopt_compression"), std::string::npos) << required;
  ExpectError("KHR_draco_mesh_compression is not supported", [](Json& j) {
    j["extensionsUsed"] = {"KHR_draco_mesh_compression"};
    j["accessors"][2].erase("bufferView");
  });
  ExpectError("meshes[0].primitives[0].extensions.KHR_draco_mesh_compression", [](Json& j) {
    j["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = Json::object();
    j["accessors"][0].erase("bufferView");
  });
}

TEST(GltfErrors, FilesThatAreNotThereOrElsewhere) {
  GltfFile file;
  file.AddNode({{"mesh", file.AddSquare()}});
  GltfFolder folder;
  for (const std::string uri : {"gone.bin", "../up.bin", "/etc/passwd", "http://host/x.bin"}) {
    folder.Write("scene.gltf", file.TextNaming(uri));
    const absl::Status status = folder.Read().status();
    EXPECT_FALSE(status.ok()) << uri;
    EXPECT_EQ(std::string(status.message()).find("scene.gltf:buffers: "), 0u) << status;
  }
  EXPECT_EQ(folder.Read("other.glb").status().code(), absl::StatusCode::kNotFound);
}

TEST(GltfErrors, DeepNestingEnds) {
  GltfFolder folder;
  for (const char open : {'[', '{'}) {
    std::string text = R"({"asset":{"version":"2.0"},"extras":)";
    for (int i = 0; i < 100000; ++i) text += open == '[' ? "[" : "{\"a\":";
    folder.Write("scene.gltf", text);
    EXPECT_NE(std::string(folder.Read().status().message()).find("nested"), std::string::npos);
  }
}

/// Changes bytes of a sound file by a fixed sequence of numbers.
class Mutator {
 public:
  explicit Mutator(uint64_t seed) : random_(seed) {}

  std::string Mutate(std::string bytes) {
    for (uint64_t changes = 1 + Below(3); changes > 0; --changes) MutateOnce(bytes);
    return bytes;
  }

 private:
  uint64_t Below(uint64_t n) { return random_() % n; }

  void MutateOnce(std::string& bytes) {
    static constexpr std::string_view kPieces[] = {"-1",   "0",  "4294967295", "1e39", "null",
                                                   "\"\"", "[]", "{}",         "99",   "true",
                                                   "5126", ",",  "]"};
    if (bytes.empty()) bytes = " ";
    const size_t at = Below(bytes.size());
    const size_t length = std::min<size_t>(1 + Below(12), bytes.size() - at);
    switch (Below(6)) {
      case 0:
        bytes[at] = static_cast<char>(Below(256));
        break;
      case 1:
        bytes.erase(at, length);
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3: {
        const std::string_view piece = kPieces[Below(std::size(kPieces))];
        bytes.replace(at, length, piece);
        break;
      }
      default: {
        // A number becomes another one: most lies of a file that stays sound JSON.
        size_t digit = bytes.find_first_of("0123456789", at);
        if (digit != std::string::npos) bytes[digit] = static_cast<char>('0' + Below(10));
      }
    }
  }

  std::mt19937_64 random_;
};

/// A file with a little of everything.
GltfFile Everything() {
  GltfFile file;
  const int colors = file.Add<uint8_t>({255, 0, 51, 0, 255, 51, 0, 0, 51, 255, 9, 9}, "VEC3",
                                       GltfFile::kUnsignedByte, true);
  const int normals = file.AddFloats({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  const int square = file.AddSquare({{"attributes", {{"COLOR_0", colors}, {"NORMAL", normals}}}});
  const std::vector<uint8_t> places = {0};
  const std::vector<float> values = {0, 0, 1};
  const int sparse = file.AddFloats({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  file.json["accessors"][sparse]["sparse"] = {
      {"count", 1},
      {"indices", {{"bufferView", file.AddBytes(places.data(), 1)}, {"componentType", 5121}}},
      {"values", {{"bufferView", file.AddBytes(values.data(), 12)}}}};
  const int textured = file.AddSquare({{"material", 0}});
  file.Append("materials",
              {{"pbrMetallicRoughness",
                {{"baseColorTexture",
                  {{"index", 0}, {"extensions", {{"KHR_texture_transform", {{"rotation", 1}}}}}}}}},
               {"emissiveFactor", {1, 1, 1}},
               {"alphaMode", "MASK"},
               {"extensions",
                {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}},
                 {"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
                 {"KHR_materials_volume", {{"thicknessFactor", 1}}}}}});
  const std::string image = "\x89PNG and no more";
  file.Append("images", {{"bufferView", file.AddBytes(image.data(), image.size())},
                         {"mimeType", "image/png"}});
  file.Append("samplers", {{"wrapS", 33648}});
  file.Append("textures", {{"source", 0}, {"sampler", 0}});
  file.Append("cameras", {{"type", "perspective"},
                          {"perspective", {{"yfov", 0.5}, {"znear", 0.1}, {"aspectRatio", 1}}}});
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "spot"}, {"intensity", 3}, {"spot", {{"outerConeAngle", 0.5}}}}};
  file.AddNode({{"mesh", square}, {"rotation", {0, 0, 0, 1}}});
  file.AddNode({{"mesh", square}, {"scale", {2, 1, -1}}});
  file.AddNode({{"mesh", textured}, {"camera", 0}});
  const Json strip = {{"mode", 5}, {"attributes", {{"POSITION", sparse}}}};
  file.AddNode({{"mesh", file.Append("meshes", {{"primitives", {strip}}})},
                {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return file;
}

/// Reads `mutants` mutants; both outcomes must be met often, or they would test nothing.
void ExpectStatuses(const std::string& name, const std::string& bytes, int mutants, uint64_t seed) {
  GltfFolder folder;
  folder.Write(name, bytes);
  ASSERT_TRUE(folder.Read(name).ok()) << folder.Read(name).status();
  Mutator mutator(seed);
  int sound = 0;
  for (int i = 0; i < mutants; ++i) {
    folder.Write(name, mutator.Mutate(bytes));
    const absl::StatusOr<SceneFile> scene = folder.Read(name);
    sound += scene.ok();
    if (!scene.ok()) {
      ASSERT_FALSE(scene.status().message().empty());
      ASSERT_EQ(scene.status().message().find('\n'), absl::string_view::npos) << scene.status();
      continue;
    }
    // What is read is sound, whatever it is.
    for (const ShapeDescription& shape : scene->scene.shapes) {
      const auto& mesh = std::get<TriangleMeshShape>(shape.geometry);
      for (const auto& triangle : mesh.triangles) {
        for (const uint32_t index : triangle) ASSERT_LT(index, mesh.positions.size());
      }
      ASSERT_LT(static_cast<size_t>(shape.material), scene->scene.materials.size());
    }
  }
  EXPECT_GT(sound, mutants / 50);
  EXPECT_LT(sound, mutants * 9 / 10);
}

TEST(GltfMutants, OfTextAlwaysGiveAStatus) {
  ExpectStatuses("scene.gltf", Everything().Text(), 2000, 1);
}
TEST(GltfMutants, OfBinaryAlwaysGiveAStatus) {
  ExpectStatuses("scene.glb", Everything().Glb(), 2000, 2);
}

}  // namespace
}  // namespace strata
