// Whatever the bytes of a scene's files are, reading them ends with a status. Each mutant is a
// sound file with a few bytes changed, cut, repeated or exchanged by a fixed sequence of numbers.

#include <gtest/gtest.h>

#include <random>
#include <string>

#include "tests/pbrt/ply_bytes.h"
#include "tests/pbrt/scene_folder.h"
#include "worker/pbrt/ply.h"

namespace strata {
namespace {

class Mutator {
 public:
  explicit Mutator(uint64_t seed) : random_(seed) {}

  std::string Mutate(std::string text) {
    for (uint64_t changes = 1 + Below(4); changes > 0; --changes) MutateOnce(text);
    return text;
  }

 private:
  uint64_t Below(uint64_t n) { return random_() % n; }

  void MutateOnce(std::string& text) {
    static constexpr std::string_view kPieces[] = {"\"",
                                                   "[",
                                                   "]",
                                                   "-1",
                                                   "1e39",
                                                   "nan",
                                                   "inf",
                                                   "99999999999",
                                                   "0",
                                                   "\n",
                                                   "#",
                                                   "\\",
                                                   "AttributeBegin\n",
                                                   "AttributeEnd\n",
                                                   "WorldBegin\n",
                                                   " \"float x\" ",
                                                   "\0\xff",
                                                   "element vertex 4294967295\n",
                                                   "end_header\n"};
    if (text.empty()) text = " ";
    const size_t at = Below(text.size());
    const size_t length = std::min<size_t>(1 + Below(24), text.size() - at);
    switch (Below(6)) {
      case 0:
        text[at] = static_cast<char>(Below(256));
        break;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << Below(8)));
        break;
      case 2:
        text.erase(at, length);
        break;
      case 3:
        text.insert(Below(text.size()), text.substr(at, length));
        break;
      case 4:
        text.insert(at, kPieces[Below(std::size(kPieces))]);
        break;
      default:
        text.resize(at);
    }
  }

  std::mt19937_64 random_;
};

constexpr std::string_view kScene = R"(
Integrator "path" "integer maxdepth" 7
Sampler "sobol" "integer pixelsamples" 8
PixelFilter "mitchell" "float xradius" 2
Film "rgb" "integer xresolution" 64 "float cropwindow" [ 0 0.5 0 1 ]
LookAt 0 0 5  0 0 0  0 1 0
Camera "perspective" "float fov" 40 "float screenwindow" [ -1 1 -1 1 ]
WorldBegin
Attribute "shape" "float radius" 2
LightSource "infinite" "blackbody L" 6500
LightSource "point" "rgb I" [ 1 2 3 ] "point3 from" [ 0 1 0 ]
Texture "t" "float" "constant" "float value" 0.5
Texture "c" "spectrum" "checkerboard" "rgb tex1" [ 1 0 0 ] "integer dimension" 3
Texture "m" "spectrum" "mix" "texture tex1" "c" "texture amount" "t"
MakeNamedMaterial "a" "string type" "coateddiffuse" "texture reflectance" "m"
MakeNamedMaterial "b" "string type" "conductor" "spectrum eta" "metal-Au-eta"
Material "mix" "string materials" [ "a" "b" ] "texture amount" "t"
AttributeBegin
  Rotate 30 0 1 1 Scale 1 2 1 ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1 ]
  CoordinateSystem "here"
  AreaLightSource "diffuse" "spectrum L" [ 400 1 700 2 ] "bool twosided" true
  Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 0 0 1 ] "integer indices" [ 0 1 2 0 2 3 ]
    "normal N" [ 0 0 1 0 0 1 0 0 1 0 0 1 ] "point2 uv" [ 0 0 1 0 1 1 0 1 ]
AttributeEnd
ObjectBegin "o"
  Shape "sphere" "float zmin" -0.5
  Shape "cylinder" "float phimax" 90
  Shape "bilinearmesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 1 1 1 ]
ObjectEnd
CoordSysTransform "here"
ObjectInstance "o"
Include "part.pbrt"
)";

constexpr std::string_view kPart = R"(
Material "dielectric" "spectrum eta" "glass-BK7" "float roughness" 0.1
Shape "plymesh" "string filename" "mesh.ply"
Import "part2.pbrt"
)";

TEST(Mutants, OfScenesAlwaysGiveAStatus) {
  SceneFolder folder;
  folder.Write("mesh.ply", SquarePly(PlyLayout::kAscii));
  folder.Write("part.pbrt", kPart);
  folder.Write("part2.pbrt", "Shape \"disk\"");
  folder.Write("scene.pbrt", kScene);
  ASSERT_TRUE(folder.Read().ok()) << folder.Read().status();
  Mutator mutator(1);
  int sound = 0;
  constexpr int kMutants = 4000;
  for (int i = 0; i < kMutants; ++i) {
    folder.Write("scene.pbrt", mutator.Mutate(std::string(kScene)));
    const absl::StatusOr<PbrtScene> scene = folder.Read();
    sound += scene.ok();
    if (!scene.ok()) {
      ASSERT_FALSE(scene.status().message().empty());
    }
  }
  // Both outcomes are met often, or the mutants would test nothing.
  EXPECT_GT(sound, kMutants / 50);
  EXPECT_LT(sound, kMutants / 2);
}

TEST(Mutants, OfPlyFilesAlwaysGiveAStatus) {
  Mutator mutator(2);
  for (const PlyLayout layout :
       {PlyLayout::kAscii, PlyLayout::kLittleEndian, PlyLayout::kBigEndian}) {
    const std::string ply = SquarePly(layout);
    int sound = 0;
    constexpr int kMutants = 20000;
    for (int i = 0; i < kMutants; ++i) {
      const absl::StatusOr<TriangleMeshShape> mesh = ParsePly(mutator.Mutate(ply));
      if (!mesh.ok()) {
        ASSERT_FALSE(mesh.status().message().empty());
        continue;
      }
      ++sound;
      // What is read is sound, whatever it is.
      for (const Vec3f& p : mesh->positions) ASSERT_TRUE(IsFinite(p));
      for (const auto& triangle : mesh->triangles) {
        for (const uint32_t index : triangle) ASSERT_LT(index, mesh->positions.size());
      }
    }
    EXPECT_GT(sound, kMutants / 50);
    EXPECT_LT(sound, kMutants * 9 / 10);
  }
}

TEST(DeepNesting, EndsWithASentence) {
  std::string scopes, materials, textures = "Texture \"0\" \"float\" \"constant\"\n";
  for (int i = 0; i < 100000; ++i) scopes += "AttributeBegin ";
  EXPECT_NE(std::string(ReadWorld(scopes).status().message()).find("nested"), std::string::npos);

  for (int i = 0; i < 1000; ++i) {
    textures += "Texture \"" + std::to_string(i + 1) + "\" \"float\" \"scale\" \"texture tex\" \"" +
                std::to_string(i) + "\"\n";
    materials += "MakeNamedMaterial \"" + std::to_string(i) +
                 "\" \"string type\" \"mix\" \"string materials\" [ \"" + std::to_string(i + 1) +
                 "\" \"" + std::to_string(i + 1) + "\" ]\n";
  }
  materials += "MakeNamedMaterial \"1000\" \"string type\" \"diffuse\"";
  EXPECT_NE(std::string(ReadWorld(textures).status().message()).find("deep"), std::string::npos);
  EXPECT_NE(std::string(ReadWorld(materials).status().message()).find("deep"), std::string::npos);
  // Brackets and quotes are not nested by recursion either.
  EXPECT_FALSE(ReadText(std::string(1000000, '[')).ok());
  EXPECT_FALSE(ReadText(std::string(999999, '"')).ok());
}

}  // namespace
}  // namespace strata
