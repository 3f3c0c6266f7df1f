#include <gtest/gtest.h>

#include <cmath>

#include "tests/gltf/gltf_file.h"

// What a glTF material becomes.

namespace strata {
namespace {

/// The square's material, of a file whose only material is `material`.
struct ReadMaterial {
  SceneFile file;
  const ShapeDescription& shape() const { return file.scene.shapes.at(0); }
  template <typename Material = MetallicRoughnessMaterial>
  const Material& material() const {
    return std::get<Material>(file.scene.materials.at(shape().material));
  }
  Rgb Constant(TextureId id) const {
    return std::get<ConstantTexture>(file.scene.textures.at(id)).value;
  }
  const ImageTexture& Image(TextureId id) const {
    return std::get<ImageTexture>(file.scene.textures.at(id));
  }
};

/// A PNG of 2x2 pixels.
constexpr const char* kImage =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAIAAAACCAYAAABytg0kAAAAFUlEQVR42mP4z8DwHwyBdMP/"
    "//8ZAEZOCHkCeX4dAAAAAElFTkSuQmCC";

GltfFile FileOf(Json material) {
  GltfFile file;
  file.Append("materials", std::move(material));
  file.Append("images", {{"uri", kImage}});
  file.Append("textures", {{"source", 0}});
  file.AddNode({{"mesh", file.AddSquare({{"material", 0}})}});
  return file;
}

ReadMaterial Read(Json material) {
  absl::StatusOr<SceneFile> file = FileOf(std::move(material)).Read();
  EXPECT_TRUE(file.ok()) << file.status();
  return {*std::move(file)};
}

TEST(GltfMaterial, DefaultsAreAWhiteRoughMetal) {
  const ReadMaterial read = Read(Json::object());
  EXPECT_EQ(read.Constant(read.material().base_color), (Rgb{1, 1, 1}));
  EXPECT_EQ(read.Constant(read.material().metallic).r, 1);
  EXPECT_EQ(read.Constant(read.material().roughness).r, 1);
  EXPECT_FLOAT_EQ(read.material().f0, 0.04f);
  EXPECT_FALSE(read.shape().emission);
}

TEST(GltfMaterial, FactorsMultiplyTextures) {
  const ReadMaterial read = Read({{"pbrMetallicRoughness",
                                   {{"baseColorFactor", {0.5, 0.25, 1, 1}},
                                    {"baseColorTexture", {{"index", 0}}},
                                    {"metallicFactor", 0.75},
                                    {"roughnessFactor", 0.5},
                                    {"metallicRoughnessTexture", {{"index", 0}}}}}});
  const auto& m = read.material();
  const auto& base = std::get<ScaleTexture>(read.file.scene.textures[m.base_color]);
  EXPECT_EQ(read.Image(base.texture).encoding, ImageEncoding::kSrgb);
  EXPECT_EQ(read.Constant(base.scale), (Rgb{0.5f, 0.25f, 1}));
  EXPECT_EQ(read.Image(m.roughness).channel, 1);
  EXPECT_EQ(read.Image(m.roughness).scale, 0.5f);
  EXPECT_EQ(read.Image(m.metallic).channel, 2);
  EXPECT_EQ(read.Image(m.metallic).scale, 0.75f);
  EXPECT_EQ(read.Image(m.metallic).encoding, ImageEncoding::kLinear);
  EXPECT_TRUE(read.Image(m.metallic).embedded);
}

TEST(GltfMaterial, SamplersWrapAndFilter) {
  GltfFile file = FileOf({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  file.json["textures"][0]["sampler"] = 0;
  const auto scene = file.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  const ReadMaterial read{*scene};
  const ImageTexture& image = read.Image(read.material().base_color);
  EXPECT_EQ(image.wrap, ImageWrap::kClamp);
  EXPECT_EQ(image.wrap_t, ImageWrap::kMirror);
  EXPECT_TRUE(image.nearest);
}

TEST(GltfMaterial, EmissionHasStrengthAndSides) {
  Json material = {
      {"emissiveFactor", {0.5, 1, 0}},
      {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}};
  const ReadMaterial read = Read(material);
  ASSERT_TRUE(read.shape().emission);
  EXPECT_EQ(read.shape().emission->radiance, (Rgb{4, 8, 0}));
  EXPECT_FALSE(read.shape().emission->two_sided);
  EXPECT_TRUE(read.file.scene.lights.empty()) << "a lamp needs no light beside it";
  material["doubleSided"] = true;
  material["emissiveTexture"] = {{"index", 0}};
  const ReadMaterial mapped = Read(material);
  EXPECT_TRUE(mapped.shape().emission->two_sided);
  EXPECT_EQ(mapped.Image(mapped.shape().emission->texture).encoding, ImageEncoding::kSrgb);
}

TEST(GltfMaterial, IndexAndSpecularSetTheReflectance) {
  const ReadMaterial read =
      Read({{"extensions",
             {{"KHR_materials_ior", {{"ior", 1.8}}},
              {"KHR_materials_specular",
               {{"specularFactor", 0.5}, {"specularColorFactor", {0.1, 0.2, 0.3}}}}}}});
  EXPECT_FLOAT_EQ(read.material().f0, static_cast<float>(0.8 * 0.8 / (2.8 * 2.8)));
  EXPECT_EQ(read.Constant(read.material().specular).r, 0.5f);
  EXPECT_EQ(read.Constant(read.material().specular_color), (Rgb{0.1f, 0.2f, 0.3f}));
}

TEST(GltfMaterial, ClearWallsKeepPunctualLightsOutAndThatIsSaid) {
  for (const auto& [roughness, lamps, said] :
       {std::tuple(0.0, true, true), std::tuple(0.0, false, false), std::tuple(0.1, true, false)}) {
    GltfFile file;
    file.Append("materials",
                {{"pbrMetallicRoughness", {{"roughnessFactor", roughness}}},
                 {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}}});
    file.AddNode({{"mesh", file.AddSquare({{"material", 0}})}});
    if (lamps) file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
    const auto read = file.Read();
    ASSERT_TRUE(read.ok()) << read.status();
    EXPECT_EQ(Warns(*read, "KHR_materials_transmission", "does not come through"), said);
  }
}

TEST(GltfMaterial, SpecularMapsAreAnAlphaChannelAndAColour) {
  const ReadMaterial read = Read({{"extensions",
                                   {{"KHR_materials_specular",
                                     {{"specularFactor", 0.5},
                                      {"specularTexture", {{"index", 0}}},
                                      {"specularColorTexture", {{"index", 0}}}}}}}});
  const auto& product = std::get<ScaleTexture>(read.file.scene.textures[read.material().specular]);
  EXPECT_TRUE(read.Image(product.texture).alpha);
  EXPECT_EQ(read.Constant(product.scale).r, 0.5f);
  EXPECT_EQ(read.Image(read.material().specular_color).encoding, ImageEncoding::kSrgb);
}

TEST(GltfMaterial, CoatAndTransmission) {
  const ReadMaterial read =
      Read({{"extensions",
             {{"KHR_materials_clearcoat",
               {{"clearcoatFactor", 0.75},
                {"clearcoatRoughnessTexture", {{"index", 0}}},
                {"clearcoatRoughnessFactor", 0.5}}},
              {"KHR_materials_transmission",
               {{"transmissionFactor", 0.25}, {"transmissionTexture", {{"index", 0}}}}}}}});
  EXPECT_EQ(read.Constant(read.material().coat).r, 0.75f);
  EXPECT_EQ(read.Image(read.material().coat_roughness).channel, 1);
  EXPECT_EQ(read.Image(read.material().transmission).channel, 0);
  EXPECT_EQ(read.Image(read.material().transmission).scale, 0.25f);
}

TEST(GltfMaterial, BodiesRefract) {
  const ReadMaterial read =
      Read({{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0}}},
            {"extensions",
             {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
              {"KHR_materials_ior", {{"ior", 1.33}}},
              {"KHR_materials_volume", {{"thicknessFactor", 1}}}}}});
  const MixMaterial& mix = read.material<MixMaterial>();
  EXPECT_FLOAT_EQ(std::get<DielectricMaterial>(read.file.scene.materials[mix.b]).eta, 1.33f);
  EXPECT_EQ(std::get<MetallicRoughnessMaterial>(read.file.scene.materials[mix.a]).transmission,
            kNoTexture);
  EXPECT_FALSE(Warns(read.file, "KHR_materials_volume", ""));
  EXPECT_FALSE(read.file.scene.shapes.at(0).border);
}

TEST(GltfMaterial, BodiesAbsorb) {
  const auto body = [](Json color, Json volume) {
    volume["thicknessFactor"] = 1;
    return Read({{"pbrMetallicRoughness", {{"baseColorFactor", color}}},
                 {"extensions",
                  {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
                   {"KHR_materials_volume", volume}}}});
  };
  const ReadMaterial read =
      body({1, 1, 1, 1}, {{"attenuationColor", {1, 0.5, 0}}, {"attenuationDistance", 2}});
  ASSERT_EQ(read.file.scene.media.size(), 1u);
  const MediumDescription& medium = read.file.scene.media[0];
  EXPECT_EQ(medium.absorption.r, 0);
  EXPECT_NEAR(medium.absorption.g, std::log(2) / 2, 1e-6);
  EXPECT_NEAR(medium.absorption.b, std::log(1e6) / 2, 1e-5);
  EXPECT_EQ(medium.scattering, Rgb{});
  EXPECT_EQ(read.file.scene.shapes.at(0).border, (MediumBorder{0, kNoMedium}));
  EXPECT_FALSE(Warns(read.file, "KHR_materials_volume", ""));
  EXPECT_TRUE(Warns(body({1, 1, 0.5, 1}, Json::object()).file, "KHR_materials_volume", "tint"));
}

TEST(GltfMaterial, UnlitEmitsItsColour) {
  const ReadMaterial read = Read({{"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 0, 1}}}},
                                  {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
  EXPECT_EQ(read.Constant(read.material<DiffuseMaterial>().reflectance), Rgb{});
  ASSERT_TRUE(read.shape().emission);
  EXPECT_EQ(read.Constant(read.shape().emission->texture), (Rgb{0.5f, 1, 0}));
  EXPECT_TRUE(Warns(read.file, "materials[0]", "unlit"));
}

TEST(GltfMaterial, OcclusionIsLeftOutAndSaidSo) {
  EXPECT_TRUE(Warns(Read({{"occlusionTexture", {{"index", 0}}}}).file,
                    "materials[0].occlusionTexture", "left out"));
}

/// A file of the material whose square has two sets of coordinates.
ReadMaterial ReadWithTwoSets(Json material) {
  GltfFile file = FileOf(std::move(material));
  file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] =
      file.AddFloats({0, 0, 0.5, 0, 0.5, 0.5, 0, 0.5}, "VEC2");
  const auto read = file.Read();
  EXPECT_TRUE(read.ok()) << read.status();
  return {*read};
}

TEST(GltfMaterial, ASetThatAllTexturesUseIsTheMeshes) {
  for (const Json& where :
       {Json{{"texCoord", 1}}, Json{{"extensions", {{"KHR_texture_transform", {{"texCoord", 1}}}}}},
        Json{{"texCoord", 0}, {"extensions", {{"KHR_texture_transform", {{"texCoord", 1}}}}}}}) {
    Json map = where;
    map["index"] = 0;
    const ReadMaterial read = ReadWithTwoSets(
        {{"pbrMetallicRoughness", {{"baseColorTexture", map}, {"metallicRoughnessTexture", map}}},
         {"normalTexture", map},
         {"emissiveFactor", {1, 1, 1}},
         {"emissiveTexture", map}});
    const TriangleMeshShape& mesh = OnlyMesh(read.file);
    EXPECT_EQ(mesh.uvs, (std::vector<Vec2f>{{0, 1}, {0.5f, 1}, {0.5f, 0.5f}, {0, 0.5f}}));
    EXPECT_TRUE(mesh.second_uvs.empty());
    EXPECT_FALSE(read.Image(read.material().base_color).second_uv);
    EXPECT_FALSE(Warns(read.file, "materials", "TEXCOORD"));
  }
}

TEST(GltfMaterial, TheNormalMapsSetComesFirstAndAThirdIsWarnedOf) {
  const ReadMaterial read =
      ReadWithTwoSets({{"pbrMetallicRoughness",
                        {{"baseColorTexture", {{"index", 0}}},
                         {"metallicRoughnessTexture", {{"index", 0}, {"texCoord", 1}}}}},
                       {"normalTexture", {{"index", 0}, {"texCoord", 1}}},
                       {"emissiveFactor", {1, 1, 1}},
                       {"emissiveTexture", {{"index", 0}, {"texCoord", 2}}}});
  const TriangleMeshShape& mesh = OnlyMesh(read.file);
  ASSERT_EQ(mesh.uvs.size(), 4u);
  ASSERT_EQ(mesh.second_uvs.size(), 4u);
  EXPECT_EQ(mesh.uvs[2], (Vec2f{0.5f, 0.5f}));
  EXPECT_EQ(mesh.second_uvs[2], (Vec2f{1, 1}));
  EXPECT_TRUE(read.Image(read.material().base_color).second_uv);
  EXPECT_FALSE(read.Image(read.material().roughness).second_uv);
  const SurfaceDetail& detail = read.file.scene.surface_details.at(read.shape().material);
  EXPECT_FALSE(read.Image(detail.normal_map).second_uv);
  EXPECT_FALSE(read.Image(read.shape().emission->texture).second_uv);
  EXPECT_TRUE(Warns(read.file, "materials[0].emissiveTexture", "TEXCOORD_2 is a third set"));
}

TEST(GltfMaterial, AlphaOfVerticesCounts) {
  GltfFile file = FileOf({{"alphaMode", "BLEND"}});
  file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
      file.AddFloats({1, 1, 1, 0, 1, 1, 1, 0.5, 1, 1, 1, 1, 1, 1, 1, 1}, "VEC4");
  const auto read = file.Read();
  ASSERT_TRUE(read.ok()) << read.status();
  const ReadMaterial opaque{*read};
  EXPECT_TRUE(opaque.Image(opaque.shape().alpha.texture).alpha);
}

}  // namespace
}  // namespace strata
