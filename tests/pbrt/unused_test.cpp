// What no picture can show is neither kept nor asked for.

#include <gtest/gtest.h>

#include <string>

#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

constexpr char kTriangle[] =
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";

/// A scene whose parts are all used but those of the second string.
std::string SceneText(const std::string& unused_materials, const std::string& unused_objects) {
  return R"(WorldBegin
Texture "a" "spectrum" "imagemap" "string filename" "a.png"
Texture "b" "spectrum" "constant" "rgb value" [0.1 0.2 0.3]
)" + unused_materials +
         R"(Texture "ab" "spectrum" "mix" "texture tex1" "a" "texture tex2" "b"
MakeNamedMaterial "plain" "string type" "diffuse" "texture reflectance" "ab"
MakeNamedMaterial "metal" "string type" "conductor" "float roughness" 0.3
MakeNamedMaterial "mixed" "string type" "mix" "string materials" ["metal" "plain"] "float amount" 0.25
)" + unused_objects +
         R"(ObjectBegin "placed"
NamedMaterial "mixed"
)" + kTriangle +
         R"(ObjectEnd
ObjectInstance "placed"
)";
}

TEST(UnusedParts, AreTakenOutAndTheRestStaysAsItWas) {
  SceneFolder folder;
  folder.Write("a.png", "never opened here");
  folder.Write("plain.pbrt", SceneText("", ""));
  folder.Write("full.pbrt",
               SceneText("Texture \"gone\" \"spectrum\" \"imagemap\" \"string filename\" "
                         "\"gone.png\"\n"
                         "Texture \"over\" \"spectrum\" \"scale\" \"texture tex\" \"gone\"\n"
                         "MakeNamedMaterial \"idle\" \"string type\" \"diffuse\" "
                         "\"texture reflectance\" \"over\"\n",
                         std::string("ObjectBegin \"idle\"\nNamedMaterial \"idle\"\n") + kTriangle +
                             "ObjectEnd\n"));
  const absl::StatusOr<PbrtScene> plain = folder.Read("plain.pbrt");
  const absl::StatusOr<PbrtScene> full = folder.Read("full.pbrt");
  ASSERT_TRUE(plain.ok()) << plain.status();
  ASSERT_TRUE(full.ok()) << full.status();

  EXPECT_FALSE(plain->unused.Any());
  EXPECT_EQ(full->unused.objects, 1u);
  EXPECT_EQ(full->unused.materials, 1u);
  EXPECT_EQ(full->unused.textures, 2u);
  EXPECT_EQ(full->unused.images, 1u);
  EXPECT_EQ(full->files, (std::vector<std::string>{"a.png", "full.pbrt"}));

  const SceneDescription &a = plain->scene, &b = full->scene;
  EXPECT_EQ(b.objects.size(), 1u);
  EXPECT_EQ(b.instances.at(0).object, 0);
  EXPECT_EQ(b.materials.size(), a.materials.size());
  EXPECT_EQ(b.textures.size(), a.textures.size());
  const MaterialId mixed = b.objects[0].shapes.at(0).material;
  EXPECT_EQ(mixed, a.objects[0].shapes.at(0).material);
  const auto& mix = std::get<MixMaterial>(b.materials.at(static_cast<size_t>(mixed)));
  EXPECT_TRUE(
      std::holds_alternative<ConductorMaterial>(b.materials.at(static_cast<size_t>(mix.a))));
  const auto& diffuse = std::get<DiffuseMaterial>(b.materials.at(static_cast<size_t>(mix.b)));
  const auto& blend = std::get<MixTexture>(b.textures.at(static_cast<size_t>(diffuse.reflectance)));
  EXPECT_EQ(std::get<ImageTexture>(b.textures.at(static_cast<size_t>(blend.a))).path, "a.png");
  const auto& constant = std::get<ConstantTexture>(b.textures.at(static_cast<size_t>(blend.b)));
  EXPECT_EQ(constant.value, (Rgb{0.1f, 0.2f, 0.3f}));
}

TEST(UnusedParts, AMissingImageIsAnErrorWhereItIsUsed) {
  SceneFolder folder;
  folder.Write("scene.pbrt", SceneText("", ""));
  const absl::Status status = folder.Read("scene.pbrt").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(std::string(status.message()).find("scene.pbrt:2: "), 0u) << status;
}

}  // namespace
}  // namespace strata
