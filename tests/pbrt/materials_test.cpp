#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/pbrt/parsed_scene.h"

// What a sound file says of materials and textures is what the scene holds; pbrt-v4's defaults
// where it says nothing.

namespace strata {
namespace {

TEST(Materials, HavePbrtsDefaults) {
  const PbrtScene scene = World(R"(
    Material "conductor" Shape "sphere"
    Material "dielectric" Shape "sphere"
    Material "coateddiffuse" Shape "sphere"
    Material "coatedconductor" Shape "sphere"
    Material "diffusetransmission" Shape "sphere"
    Material "thindielectric" Shape "sphere"
    Material "" Shape "sphere")");
  const auto conductor = MaterialOf<ConductorMaterial>(scene, 1);
  EXPECT_NEAR(Constant(scene, conductor.k).r, 3.2, 0.4);  // copper
  EXPECT_EQ(conductor.reflectance, kNoTexture);
  EXPECT_EQ(conductor.roughness.u, kNoTexture);
  EXPECT_TRUE(conductor.roughness.remap);
  EXPECT_EQ(MaterialOf<DielectricMaterial>(scene, 2).eta, 1.5f);
  const auto coated = MaterialOf<CoatedDiffuseMaterial>(scene, 3);
  EXPECT_EQ(Constant(scene, coated.reflectance), Rgb::Gray(0.5f));
  EXPECT_EQ(Constant(scene, coated.albedo), Rgb{});
  EXPECT_EQ(coated.thickness, 0.01f);
  EXPECT_EQ(MaterialOf<CoatedConductorMaterial>(scene, 4).interface_eta, 1.5f);
  const auto leaf = MaterialOf<DiffuseTransmissionMaterial>(scene, 5);
  EXPECT_EQ(Constant(scene, leaf.transmittance), Rgb::Gray(0.25f));
  EXPECT_EQ(MaterialOf<ThinDielectricMaterial>(scene, 6).eta, 1.5f);
  MaterialOf<InterfaceMaterial>(scene, 7);
  EXPECT_EQ(scene.scene.shapes.at(6).material, 7);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Materials, TakeOneRoughnessForBothDirections) {
  const PbrtScene scene = World(R"(
    Material "conductor" "float roughness" 0.2 "float vroughness" 0.3 "bool remaproughness" false
    Shape "sphere"
    Material "coatedconductor" "float interface.roughness" 0.1 "float conductor.uroughness" 0.4
    Shape "sphere")");
  const Roughness roughness = MaterialOf<ConductorMaterial>(scene).roughness;
  EXPECT_FLOAT_EQ(Constant(scene, roughness.u).r, 0.2f);
  EXPECT_FLOAT_EQ(Constant(scene, roughness.v).r, 0.3f);
  EXPECT_FALSE(roughness.remap);
  const auto coated = MaterialOf<CoatedConductorMaterial>(scene, 2);
  EXPECT_FLOAT_EQ(Constant(scene, coated.interface_roughness.v).r, 0.1f);
  EXPECT_FLOAT_EQ(Constant(scene, coated.conductor_roughness.u).r, 0.4f);
  EXPECT_EQ(coated.conductor_roughness.v, kNoTexture);
}

TEST(Materials, MayBeUsedBeforeTheirDefinition) {
  const PbrtScene scene = World(R"(
    NamedMaterial "later" Shape "sphere"
    MakeNamedMaterial "later" "string type" "mix" "string materials" [ "one" "two" ]
    MakeNamedMaterial "two" "string type" "dielectric" "float eta" 2
    MakeNamedMaterial "one" "string type" "diffuse"
    NamedMaterial "two" Shape "disk")");
  const auto& shapes = scene.scene.shapes;
  const auto mix = MaterialOf<MixMaterial>(scene, shapes.at(0).material);
  EXPECT_EQ(MaterialOf<DielectricMaterial>(scene, mix.b).eta, 2);
  EXPECT_EQ(shapes.at(1).material, mix.b);
  MaterialOf<DiffuseMaterial>(scene, mix.a);
}

TEST(Materials, WarnOfWhatTheyLeaveOut) {
  SceneFolder folder;
  folder.Write("bumps.png", "");
  folder.Write("scene.pbrt", R"(WorldBegin
    Material "dielectric" "spectrum eta" "glass-F11" Shape "sphere"
    Material "coateddiffuse" "float g" 0.5 "integer nsamples" 4 Shape "sphere"
    MakeNamedMaterial "a" "string type" "diffuse"
    Material "mix" "string materials" [ "a" "a" ] "string normalmap" "bumps.png" Shape "sphere")");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ(scene->warnings.size(), 3u);
  EXPECT_EQ(scene->warnings[0].where.line, 2);
  EXPECT_EQ(scene->warnings[1].where.line, 3);
  EXPECT_EQ(scene->warnings[2].where.line, 5);
  EXPECT_NEAR(MaterialOf<DielectricMaterial>(*scene, 1).eta, 1.7847, 1e-4);
  // What is left out need not be shipped.
  EXPECT_EQ(scene->files, (std::vector<std::string>{"scene.pbrt"}));
}

TEST(Materials, OfStratasOwnKindsAreRead) {
  const PbrtScene scene = World(R"(
    Material "blinn" "float eta" 1.4 "float exponent" 30 Shape "sphere"
    Material "blinn" "rgb reflectance" [ 0.9 0.8 0.7 ] Shape "sphere"
    Material "ashikhminshirley" "float exponent" 10 "float vexponent" 500
        "rgb specular" [ 0.1 0.2 0.3 ] Shape "sphere"
    MakeNamedMaterial "a" "string type" "diffuse"
    MakeNamedMaterial "b" "string type" "blinn"
    Material "mixture" "string materials" [ "a" "b" ] "float amount" 0.3 Shape "sphere")");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& shapes = scene.scene.shapes;
  const auto value = [&](TextureId id) {
    return std::get<ConstantTexture>(scene.scene.textures.at(id)).value;
  };
  const auto glass = MaterialOf<BlinnMaterial>(scene, shapes.at(0).material);
  EXPECT_FLOAT_EQ(value(glass.eta).g, 1.4f);
  EXPECT_EQ(value(glass.k), Rgb{});
  EXPECT_EQ(value(glass.exponent).r, 30);
  const auto metal = MaterialOf<BlinnMaterial>(scene, shapes.at(1).material);
  EXPECT_FLOAT_EQ(value(metal.reflectance).g, 0.8f);
  EXPECT_EQ(value(metal.exponent).r, 100);
  const auto brushed = MaterialOf<AshikhminShirleyMaterial>(scene, shapes.at(2).material);
  EXPECT_EQ(value(brushed.u_exponent).r, 10);
  EXPECT_EQ(value(brushed.v_exponent).r, 500);
  EXPECT_FLOAT_EQ(value(brushed.specular).b, 0.3f);
  const auto sum = MaterialOf<MixMaterial>(scene, shapes.at(3).material);
  EXPECT_TRUE(sum.sum);
  MaterialOf<DiffuseMaterial>(scene, sum.a);
  MaterialOf<BlinnMaterial>(scene, sum.b);
}

TEST(Materials, HaveNormalAndBumpMaps) {
  SceneFolder folder;
  folder.Write("normals.png", "");
  folder.Write("bumps.png", "");
  folder.Write("unused.png", "");
  folder.Write("scene.pbrt", R"(WorldBegin
    Texture "bumps" "float" "imagemap" "string filename" "bumps.png"
    Material "diffuse" "string normalmap" "unused.png"
    NamedMaterial "later" Shape "sphere"
    MakeNamedMaterial "later" "string type" "conductor" "string normalmap" "normals.png"
    Material "diffuse" "texture displacement" "bumps" Shape "sphere"
    Material "diffuse" "float displacement" 0.1 Shape "sphere")");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_TRUE(scene->warnings.empty());
  const SceneDescription& s = scene->scene;
  ASSERT_EQ(s.surface_details.size(), 2u);
  const SurfaceDetail& mapped = s.surface_details.at(s.shapes.at(0).material);
  const auto& image = std::get<ImageTexture>(s.textures.at(mapped.normal_map));
  EXPECT_EQ(image.path, "normals.png");
  EXPECT_EQ(image.encoding, ImageEncoding::kLinear);
  const SurfaceDetail& bumpy = s.surface_details.at(s.shapes.at(1).material);
  EXPECT_EQ(std::get<ImageTexture>(s.textures.at(bumpy.displacement)).path, "bumps.png");
  EXPECT_FALSE(s.surface_details.contains(s.shapes.at(2).material));
  EXPECT_EQ(scene->files, (std::vector<std::string>{"bumps.png", "normals.png", "scene.pbrt"}));
}

TEST(Textures, AreReadWithAllTheirParameters) {
  SceneFolder folder;
  folder.Write("tex/a.png", "");
  folder.Write("scene.pbrt", R"(WorldBegin
    Texture "image" "spectrum" "imagemap" "string filename" "tex/a.png" "string wrap" "clamp"
      "float uscale" 2 "float vdelta" 0.5 "float scale" 3 "bool invert" true
      "string encoding" "gamma 1.8" "string filter" "point"
    Texture "same name" "float" "constant" "float value" 0.25
    Texture "same name" "spectrum" "constant" "rgb value" [ 1 2 3 ]
    Texture "scaled" "spectrum" "scale" "texture tex" "image" "texture scale" "same name"
    Texture "mixed" "float" "mix" "float tex1" 2 "texture amount" "same name"
    Translate 1 0 0
    Texture "cubes" "spectrum" "checkerboard" "integer dimension" 3 "texture tex1" "scaled"
    Material "diffuse" "texture reflectance" "cubes" Shape "sphere"
    Material "diffuse" "texture reflectance" "same name" Shape "sphere"
    Material "conductor" "texture roughness" "mixed" Shape "sphere")");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  const auto& textures = scene->scene.textures;
  const auto image = std::get<ImageTexture>(textures.at(1));  // 0 is the default material's gray
  EXPECT_EQ(image.path, "tex/a.png");
  EXPECT_EQ(image.wrap, ImageWrap::kClamp);
  EXPECT_EQ(image.mapping.su, 2);
  EXPECT_EQ(image.mapping.dv, 0.5f);
  EXPECT_EQ(image.scale, 3);
  EXPECT_TRUE(image.invert);
  EXPECT_TRUE(image.nearest);
  EXPECT_FALSE(image.scalar);
  EXPECT_EQ(image.encoding, ImageEncoding::kGamma);
  EXPECT_FLOAT_EQ(image.gamma, 1.8f);
  EXPECT_EQ(scene->files, (std::vector<std::string>{"scene.pbrt", "tex/a.png"}));
  const auto scaled = std::get<ScaleTexture>(textures.at(4));
  EXPECT_EQ(scaled.texture, 1);
  EXPECT_EQ(scaled.scale, 2);
  const auto cubes = std::get<CheckerboardTexture>(
      textures.at(static_cast<size_t>(MaterialOf<DiffuseMaterial>(*scene).reflectance)));
  EXPECT_TRUE(cubes.solid);
  EXPECT_EQ(cubes.world_to_texture, Transform::Translate(-1, 0, 0));
  EXPECT_EQ(cubes.a, 4);
  EXPECT_TRUE(scene->warnings.empty());
}

TEST(Textures, OfPatternsHaveTheirParameters) {
  const PbrtScene scene = Read(R"(WorldBegin
    Translate 0 2 0
    Texture "a" "float" "fbm" "integer octaves" 3 "float roughness" 0.7
    Texture "b" "float" "windy"
    Texture "c" "spectrum" "marble" "float scale" 2 "float variation" 0.4
    Texture "d" "spectrum" "dots" "rgb inside" [ 1 0 0 ] "float uscale" 4
    Texture "e" "spectrum" "bilerp" "rgb v10" [ 0 1 0 ]
    Texture "f" "float" "wrinkled"
    Material "ashikhminshirley" "texture reflectance" "c" "texture specular" "d"
      "texture uexponent" "a" "texture vexponent" "b" Shape "sphere"
    Material "coateddiffuse" "texture reflectance" "e" "texture roughness" "f" Shape "sphere")");
  const auto& textures = scene.scene.textures;
  const auto noise = [&](NoiseTexture::Kind kind) {
    for (const TextureDescription& texture : textures) {
      const auto* found = std::get_if<NoiseTexture>(&texture);
      if (found && found->kind == kind) return *found;
    }
    ADD_FAILURE() << "no noise of kind " << static_cast<int>(kind);
    return NoiseTexture{};
  };
  using Kind = NoiseTexture::Kind;
  EXPECT_EQ(noise(Kind::kFbm).octaves, 3);
  EXPECT_EQ(noise(Kind::kFbm).roughness, 0.7f);
  EXPECT_EQ(noise(Kind::kFbm).world_to_texture, Transform::Translate(0, -2, 0));
  EXPECT_EQ(noise(Kind::kWindy).world_to_texture, Transform::Translate(0, -2, 0));
  EXPECT_EQ(noise(Kind::kMarble).scale, 2);
  EXPECT_EQ(noise(Kind::kMarble).variation, 0.4f);
  EXPECT_EQ(noise(Kind::kWrinkled).octaves, 8);
  bool dots = false, bilinear = false;
  for (const TextureDescription& texture : textures) {
    const auto value = [&](TextureId id) { return std::get<ConstantTexture>(textures[id]).value; };
    if (const auto* d = std::get_if<DotsTexture>(&texture)) {
      dots = true;
      EXPECT_EQ(value(d->inside), (Rgb{1, 0, 0}));
      EXPECT_EQ(value(d->outside), Rgb{});
      EXPECT_EQ(d->mapping.su, 4);
    }
    if (const auto* b = std::get_if<BilinearTexture>(&texture)) {
      bilinear = true;
      EXPECT_EQ(value(b->corners[0]), Rgb{});
      EXPECT_EQ(value(b->corners[1]), (Rgb{0, 1, 0}));
      EXPECT_EQ(value(b->corners[2]), Rgb::Gray(1));
    }
  }
  EXPECT_TRUE(dots && bilinear);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Textures, MayBeDefinedAfterTheMaterialsThatNameThem) {
  const PbrtScene scene = Read(R"(WorldBegin
    Material "diffuse" "texture reflectance" "late"
    Shape "sphere" "texture alpha" "holes"
    Texture "inner" "spectrum" "constant" "rgb value" [ 0.1 0.2 0.3 ]
    Texture "late" "spectrum" "scale" "texture tex" "inner" "float scale" 0.5
    Texture "holes" "float" "checkerboard")");
  const auto& textures = scene.scene.textures;
  const auto scale = std::get<ScaleTexture>(
      textures.at(static_cast<size_t>(MaterialOf<DiffuseMaterial>(scene).reflectance)));
  EXPECT_EQ(std::get<ConstantTexture>(textures.at(static_cast<size_t>(scale.texture))).value,
            (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_TRUE(std::holds_alternative<CheckerboardTexture>(
      textures.at(static_cast<size_t>(scene.scene.shapes.at(0).alpha.texture))));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Names, OfTexturesAndMaterialsAreReplacedFromTheirSecondDefinitionOn) {
  const PbrtScene scene = Read(R"(WorldBegin
    Texture "t" "spectrum" "constant" "rgb value" [ 0.1 0.1 0.1 ]
    MakeNamedMaterial "m" "string type" "diffuse" "texture reflectance" "t"
    NamedMaterial "m" Shape "sphere"
    Texture "t" "spectrum" "constant" "rgb value" [ 0.2 0.2 0.2 ]
    MakeNamedMaterial "m" "string type" "diffuse" "texture reflectance" "t"
    NamedMaterial "m" Shape "sphere")");
  const auto gray = [&](size_t shape) {
    const MaterialId id = scene.scene.shapes.at(shape).material;
    const auto diffuse =
        std::get<DiffuseMaterial>(scene.scene.materials.at(static_cast<size_t>(id)));
    return std::get<ConstantTexture>(
               scene.scene.textures.at(static_cast<size_t>(diffuse.reflectance)))
        .value.r;
  };
  EXPECT_EQ(gray(0), 0.1f);
  EXPECT_EQ(gray(1), 0.2f);
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_EQ(scene.warnings[0].where.line, 5);
  EXPECT_NE(scene.warnings[1].text.find("defined again"), std::string::npos);
}

TEST(Textures, OfOtherFiltersWarn) {
  SceneFolder folder;
  folder.Write("a.png", "");
  folder.Write("scene.pbrt", R"(WorldBegin
    Texture "a" "float" "imagemap" "string filename" "a.png" "string filter" "bilinear"
    Texture "b" "float" "imagemap" "string filename" "a.png" "string filter" "trilinear"
    Texture "c" "float" "imagemap" "string filename" "a.png" "string filter" "EWA")");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  ASSERT_EQ(scene->warnings.size(), 2u);
  EXPECT_EQ(scene->warnings[0].where.line, 3);
  EXPECT_EQ(scene->warnings[1].where.line, 4);
}

}  // namespace
}  // namespace strata
