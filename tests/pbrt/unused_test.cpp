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

TEST(UnusedParts, MeshFilesAreReadWhereTheyAreUsedAlone) {
  SceneFolder folder;
  const std::string triangle =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float "
      "z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  folder.Write("kept.ply", triangle);
  folder.Write("lamp.ply", triangle);
  folder.Write(
      "empty.ply",
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty "
      "float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n");
  const auto read = [&](const std::string& idle) {
    folder.Write("scene.pbrt",
                 "WorldBegin\nObjectBegin \"idle\"\n" + idle +
                     "ObjectEnd\nObjectBegin \"placed\"\n"
                     "Shape \"plymesh\" \"string filename\" \"kept.ply\"\n"
                     "ObjectEnd\nObjectInstance \"placed\"\n"
                     "Shape \"plymesh\" \"string filename\" \"empty.ply\"\n"
                     "AttributeBegin\nAreaLightSource \"diffuse\" \"float power\" 1\n"
                     "Shape \"plymesh\" \"string filename\" \"lamp.ply\"\nAttributeEnd\n");
    return folder.Read();
  };
  const auto scene = read("Shape \"plymesh\" \"string filename\" \"gone.ply\"\n");
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ(scene->files,
            (std::vector<std::string>{"empty.ply", "kept.ply", "lamp.ply", "scene.pbrt"}));
  const auto triangles = [](const ShapeDescription& shape) {
    const auto& mesh = std::get<TriangleMeshShape>(shape.geometry);
    return mesh.unread_file.empty() ? mesh.triangles.size() : 0;
  };
  EXPECT_EQ(triangles(scene->scene.objects.at(0).shapes.at(0)), 1u);
  ASSERT_EQ(scene->scene.shapes.size(), 1u);
  EXPECT_EQ(triangles(scene->scene.shapes[0]), 1u);
  EXPECT_TRUE(scene->scene.shapes[0].emission.has_value());
  EXPECT_EQ(scene->warnings.size(), 1u);  // Of the mesh without faces.

  const absl::Status outside =
      read("Shape \"plymesh\" \"string filename\" \"../gone.ply\"\n").status();
  EXPECT_EQ(outside.code(), absl::StatusCode::kInvalidArgument) << outside;
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
