#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/pbrt/scene_folder.h"
#include "worker/geometry/texture.h"

// Words of pbrt-v3: those that mean what a word of v4 means are read as that and noted, the others
// are refused with what to use.

namespace strata {
namespace {

PbrtScene MustRead(const std::string& text) {
  absl::StatusOr<PbrtScene> scene = ReadText(text);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *std::move(scene) : PbrtScene{};
}
PbrtScene World(const std::string& text) { return MustRead("WorldBegin\n" + text); }

/// The material of the only shape.
template <typename M>
M MaterialOf(const PbrtScene& scene) {
  const auto* material =
      std::get_if<M>(&scene.scene.materials.at(scene.scene.shapes.at(0).material));
  EXPECT_NE(material, nullptr);
  return material ? *material : M{};
}

Rgb ColorOf(const PbrtScene& scene, TextureId id) {
  return std::get<ConstantTexture>(scene.scene.textures.at(id)).value;
}

bool Warns(const PbrtScene& scene, std::string_view text) {
  for (const SceneWarning& warning : scene.warnings) {
    if (warning.text.find(text) != std::string::npos) return true;
  }
  return false;
}

TEST(Version3, AWholeFileIsReadAsTheOneOfVersion4) {
  const PbrtScene old = MustRead(R"(
    LookAt 0 0 -5  0 0 0  0 1 0
    Camera "perspective" "float fov" [ 45 ]
    Sampler "02sequence" "integer pixelsamples" [ 64 ]
    PixelFilter "box" "float xwidth" [ 0.75 ] "float ywidth" [ 0.75 ]
    SurfaceIntegrator "path" "integer maxdepth" [ 7 ]
    Film "image" "integer xresolution" [ 40 ] "integer yresolution" [ 30 ]
    WorldBegin
      Texture "t" "color" "checkerboard" "color tex1" [ 1 0 0 ] "color tex2" [ 0 0 1 ]
      Material "matte" "texture Kd" "t"
      AttributeBegin
        AreaLightSource "area" "rgb L" [ 1 2 3 ] "integer nsamples" [ 4 ]
        Shape "sphere"
      AttributeEnd
    WorldEnd)");
  const PbrtScene now = MustRead(R"(
    LookAt 0 0 -5  0 0 0  0 1 0
    Camera "perspective" "float fov" [ 45 ]
    Sampler "sobol" "integer pixelsamples" [ 64 ]
    PixelFilter "box" "float xradius" [ 0.75 ] "float yradius" [ 0.75 ]
    Integrator "path" "integer maxdepth" [ 7 ]
    Film "rgb" "integer xresolution" [ 40 ] "integer yresolution" [ 30 ]
    WorldBegin
      Texture "t" "spectrum" "checkerboard" "rgb tex1" [ 1 0 0 ] "rgb tex2" [ 0 0 1 ]
      Material "diffuse" "texture reflectance" "t"
      AttributeBegin
        AreaLightSource "diffuse" "rgb L" [ 1 2 3 ]
        Shape "sphere"
      AttributeEnd)");
  EXPECT_TRUE(now.warnings.empty());
  const FrameDefaults &a = old.scene.defaults, &b = now.scene.defaults;
  EXPECT_EQ(a.width, b.width);
  EXPECT_EQ(a.spp, b.spp);
  EXPECT_EQ(a.max_depth, b.max_depth);
  EXPECT_EQ(a.filter.radius_x, b.filter.radius_x);
  EXPECT_EQ(MaterialOf<DiffuseMaterial>(old).reflectance,
            MaterialOf<DiffuseMaterial>(now).reflectance);
  EXPECT_EQ(old.scene.shapes.at(0).emission->radiance, (Rgb{1, 2, 3}));
  for (const char* note :
       {"Sampler \"02sequence\" is read as \"sobol\"", "\"xwidth\" of PixelFilter is read as",
        "SurfaceIntegrator is read as Integrator", "Film \"image\" is read as \"rgb\"",
        "texture type \"color\" is read as \"spectrum\"",
        "parameter type \"color\" is read as \"rgb\"", "Material \"matte\" is read as \"diffuse\"",
        "\"Kd\" of Material is read as", "AreaLightSource \"area\" is read as \"diffuse\"",
        "\"nsamples\" of AreaLightSource is ignored", "WorldEnd is read as the end"})
    EXPECT_TRUE(Warns(old, note)) << note;
}

TEST(Version3, MaterialsHaveTheirDefaults) {
  const PbrtScene mirror = World("Material \"mirror\" Shape \"sphere\"");
  const auto silver = MaterialOf<ConductorMaterial>(mirror);
  EXPECT_EQ(ColorOf(mirror, silver.reflectance), Rgb::Gray(0.9f));
  EXPECT_EQ(silver.roughness.u, kNoTexture);
  const PbrtScene plastic = World("Material \"plastic\" \"rgb Ks\" [ 1 1 1 ] Shape \"sphere\"");
  EXPECT_EQ(ColorOf(plastic, MaterialOf<CoatedDiffuseMaterial>(plastic).reflectance),
            Rgb::Gray(0.25f));
  EXPECT_TRUE(Warns(plastic, "\"Ks\" of Material is ignored; the coat reflects by its index"));
  const PbrtScene glass = World("Material \"glass\" \"float index\" 1.3 Shape \"sphere\"");
  EXPECT_FLOAT_EQ(MaterialOf<DielectricMaterial>(glass).eta, 1.3f);
}

TEST(Version3, TranslucentMaterialsMultiplyBothPartsByKd) {
  const PbrtScene leaf =
      World("Material \"translucent\" \"rgb reflect\" [ .1 .2 .3 ] Shape \"sphere\"");
  const auto both = MaterialOf<DiffuseTransmissionMaterial>(leaf);
  EXPECT_EQ(ColorOf(leaf, both.reflectance), (Rgb{0.025f, 0.05f, 0.075f}));
  EXPECT_EQ(ColorOf(leaf, both.transmittance), Rgb::Gray(0.125f));
  const PbrtScene paper = World(
      "Material \"translucent\" \"rgb Kd\" [ 1 .5 .2 ] \"rgb transmit\" [ 1 1 1 ] Shape "
      "\"sphere\"");
  const auto sheet = MaterialOf<DiffuseTransmissionMaterial>(paper);
  EXPECT_EQ(ColorOf(paper, sheet.reflectance), (Rgb{0.5f, 0.25f, 0.1f}));
  EXPECT_EQ(ColorOf(paper, sheet.transmittance), (Rgb{1, 0.5f, 0.2f}));
  // A texture, where both parts are the same gray.
  const std::string veins =
      "Texture \"veins\" \"spectrum\" \"checkerboard\" Material \"translucent\" \"texture Kd\" "
      "\"veins\" ";
  const PbrtScene veined = World(veins +
                                 "\"rgb reflect\" [ .4 .4 .4 ] \"rgb transmit\" "
                                 "[ .4 .4 .4 ] Shape \"sphere\"");
  const auto textured = MaterialOf<DiffuseTransmissionMaterial>(veined);
  EXPECT_EQ(textured.reflectance, textured.transmittance);
  EXPECT_TRUE(
      std::holds_alternative<CheckerboardTexture>(veined.scene.textures.at(textured.reflectance)));
  EXPECT_FLOAT_EQ(textured.scale, 0.4f);
  EXPECT_FALSE(Warns(veined, "\"Kd\""));
  // Where they are not, it is told that it is dropped.
  EXPECT_TRUE(Warns(World(veins + "\"rgb reflect\" [ .4 .1 .4 ] Shape \"sphere\""), "\"Kd\""));
}

TEST(Version3, PlasticAndUberWithoutASpecularPartAreMatte) {
  for (const std::string& words :
       {std::string("\"plastic\""), std::string("\"uber\" \"rgb Kr\" [ 0 0 0 ]")}) {
    const PbrtScene scene =
        World("Material " + words +
              " \"rgb Kd\" [ .5 .4 .3 ] \"rgb Ks\" [ 0 0 0 ] \"float roughness\" 0.2 Shape "
              "\"sphere\"");
    EXPECT_EQ(ColorOf(scene, MaterialOf<DiffuseMaterial>(scene).reflectance),
              (Rgb{0.5f, 0.4f, 0.3f}));
    EXPECT_TRUE(Warns(scene, "without \"Ks\" is read as \"matte\""));
  }
  const PbrtScene shiny =
      World("Material \"uber\" \"rgb Kr\" [ .1 .1 .1 ] \"rgb Ks\" [ 0 0 0 ] Shape \"sphere\"");
  EXPECT_EQ(ColorOf(shiny, MaterialOf<CoatedDiffuseMaterial>(shiny).reflectance), Rgb::Gray(0.25f));
}

TEST(Version3, GammasOfImagesAreEncodings) {
  const auto image = [](const std::string& gamma) {
    SceneFolder folder;
    folder.Write("t.png", "");
    folder.Write(
        "scene.pbrt",
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\" " +
            gamma + " Material \"diffuse\" \"texture reflectance\" \"t\" Shape \"sphere\"");
    const absl::StatusOr<PbrtScene> read = folder.Read();
    EXPECT_TRUE(read.ok()) << read.status();
    const PbrtScene scene = read.value_or(PbrtScene{});
    EXPECT_TRUE(Warns(scene, "\"gamma\" of Texture is read as \"encoding\"")) << gamma;
    return std::get<ImageTexture>(
        scene.scene.textures.at(MaterialOf<DiffuseMaterial>(scene).reflectance));
  };
  EXPECT_EQ(image("\"bool gamma\" true").encoding, ImageEncoding::kSrgb);
  EXPECT_EQ(image("\"bool gamma\" false").encoding, ImageEncoding::kLinear);
  const ImageTexture old = image("\"float gamma\" 2.2");
  EXPECT_EQ(old.encoding, ImageEncoding::kGamma);
  EXPECT_FLOAT_EQ(old.gamma, 2.2f);
}

TEST(Version3, RoughnessKeepsItsAlpha) {
  const PbrtScene metal = World("Material \"metal\" \"float roughness\" 0.1 Shape \"sphere\"");
  const Roughness roughness = MaterialOf<ConductorMaterial>(metal).roughness;
  EXPECT_FALSE(roughness.remap);
  // pbrt-v3's RoughnessToAlpha(0.1).
  EXPECT_NEAR(ColorOf(metal, roughness.u).r, 0.46176, 1e-4);
  const PbrtScene plain = World(
      "Material \"metal\" \"float roughness\" 0.1 \"bool remaproughness\" \"false\" Shape "
      "\"sphere\"");
  EXPECT_FLOAT_EQ(ColorOf(plain, MaterialOf<ConductorMaterial>(plain).roughness.u).r, 0.1f);
  EXPECT_FALSE(MaterialOf<ConductorMaterial>(plain).roughness.remap);
}

TEST(Version3, NamedMaterialsAndMixesAreTranslatedToo) {
  const PbrtScene scene = World(R"(
    MakeNamedMaterial "a" "string type" "matte" "rgb Kd" [ 1 0 0 ]
    MakeNamedMaterial "b" "string type" "mirror"
    MakeNamedMaterial "m" "string type" "mix" "string namedmaterial1" "a"
      "string namedmaterial2" "b" "rgb amount" [ 0.3 0.3 0.3 ]
    NamedMaterial "m" Shape "sphere")");
  const auto mix = MaterialOf<MixMaterial>(scene);
  // v3's amount is of the first, v4's of the second.
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.scene.materials.at(mix.a)));
  EXPECT_TRUE(std::holds_alternative<DiffuseMaterial>(scene.scene.materials.at(mix.b)));
  EXPECT_FLOAT_EQ(ColorOf(scene, mix.amount).r, 0.3f);
}

TEST(Version3, CamerasFiltersAndShapesHaveNewWords) {
  const PbrtScene scene = MustRead(R"(
    Camera "environment"
    PixelFilter "gaussian" "float xwidth" 2 "float ywidth" 2 "float alpha" 2
    WorldBegin
    Shape "loopsubdiv" "integer nlevels" 1 "point P" [ 0 0 0 1 0 0 0 1 0 ] "integer indices" [ 0 1 2 ]
    Shape "trianglemesh" "point P" [ 0 0 0 1 0 0 0 1 0 ] "float st" [ 0 0 1 0 0 1 ])");
  EXPECT_EQ(scene.scene.camera.kind, CameraKind::kSpherical);
  EXPECT_EQ(scene.scene.camera.spherical_mapping, EnvironmentMapping::kLatLong);
  EXPECT_NEAR(scene.scene.defaults.filter.sigma, 0.5, 1e-6);
  EXPECT_EQ(std::get<TriangleMeshShape>(scene.scene.shapes.at(0).geometry).triangles.size(), 4u);
  EXPECT_EQ(std::get<TriangleMeshShape>(scene.scene.shapes.at(1).geometry).uvs.size(), 3u);
}

TEST(Version3, ColourScalesOfLightsMultiplyTheirColours) {
  const PbrtScene scene = World(R"(
    AreaLightSource "area" "rgb L" [ 1 2 3 ] "color scale" [ 2 4 0.5 ] Shape "sphere"
    AreaLightSource "diffuse" "blackbody L" [ 5000 3 ] "rgb scale" [ 2 2 2 ] Shape "sphere"
    AreaLightSource "diffuse" "blackbody L" [ 5000 6 ] Shape "sphere"
    LightSource "point" "color I" [ 1 1 2 ] "color scale" [ 3 2 1 ])");
  const auto radiance = [&](size_t i) { return scene.scene.shapes.at(i).emission->radiance; };
  EXPECT_EQ(radiance(0), (Rgb{2, 8, 1.5f}));
  EXPECT_FLOAT_EQ(radiance(1).g, radiance(2).g);
  EXPECT_EQ(std::get<PointLightDescription>(scene.scene.lights.at(0).light).intensity,
            (Rgb{3, 2, 2}));
}

TEST(Version3, ImagesOfLightsLieByLatitudeAndLongitude) {
  SceneFolder folder;
  for (const char* name : {"sky.exr", "lamp.png", "slide.png"}) folder.Write(name, "");
  folder.Write("scene.pbrt", R"(WorldBegin
    LightSource "infinite" "string mapname" "sky.exr" "rgb L" [ 3 3 3 ] "color scale" [ 2 2 2 ]
    LightSource "goniometric" "string mapname" "lamp.png" "rgb I" [ 1 2 3 ]
    LightSource "projection" "string mapname" "slide.png"
    LightSource "projection" "string mapname" "slide.png" "float fov" 30
    LightSource "point" "rgb scale" [ 5 5 5 ])");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  const auto light = [&](size_t i) { return scene->scene.lights.at(i).light; };
  const auto sky = std::get<ImageInfiniteLightDescription>(light(0));
  EXPECT_EQ(sky.path, "sky.exr");
  EXPECT_EQ(sky.mapping, EnvironmentMapping::kLatLong);
  EXPECT_EQ(sky.scale, 6);
  const auto lamp = std::get<GoniometricLightDescription>(light(1));
  EXPECT_EQ(lamp.path, "lamp.png");
  EXPECT_EQ(lamp.mapping, EnvironmentMapping::kLatLong);
  EXPECT_EQ(lamp.intensity, (Rgb{1, 2, 3}));
  EXPECT_EQ(std::get<ProjectionLightDescription>(light(2)).fov, 45) << "v3's default";
  EXPECT_EQ(std::get<ProjectionLightDescription>(light(3)).fov, 30);
  EXPECT_EQ(std::get<PointLightDescription>(light(4)).intensity, Rgb::Gray(5));
  EXPECT_TRUE(Warns(*scene, "\"mapname\" of LightSource is read as \"filename\""));
}

TEST(Version3, ScaleTexturesMultiplyColours) {
  const PbrtScene scene = MustRead(R"(WorldBegin
    Texture "a" "color" "constant" "color value" [ 0.5 0.25 1 ]
    Texture "f" "float" "constant" "float value" 0.5
    Texture "ab" "color" "scale" "texture tex1" "a" "color tex2" [ 0.5 1 0.25 ]
    Texture "ba" "color" "scale" "color tex1" [ 0.5 1 0.25 ] "texture tex2" "a"
    Texture "af" "spectrum" "scale" "texture tex" "a" "texture scale" "f"
    Material "matte" "texture Kd" "ab" Shape "sphere"
    Material "matte" "texture Kd" "ba" Shape "sphere"
    Material "matte" "texture Kd" "af" Shape "sphere")");
  ASSERT_EQ(scene.scene.shapes.size(), 3u);
  const auto set = TextureSet::Load(scene.scene.textures, DirectorySource("."));
  ASSERT_TRUE(set.ok()) << set.status();
  const auto reflectance = [&](size_t shape) {
    const auto& material = scene.scene.materials.at(scene.scene.shapes[shape].material);
    return (*set)->Eval(std::get<DiffuseMaterial>(material).reflectance, {}, {});
  };
  EXPECT_EQ(reflectance(0), (Rgb{0.25f, 0.25f, 0.25f}));
  EXPECT_EQ(reflectance(1), (Rgb{0.25f, 0.25f, 0.25f}));
  EXPECT_EQ(reflectance(2), (Rgb{0.25f, 0.125f, 0.5f}));
  // A texture of the other kind is called that.
  const auto mixed = ReadWorld(
      "Texture \"a\" \"color\" \"constant\" \"color value\" [ 1 1 1 ]\n"
      "Texture \"m\" \"float\" \"mix\" \"texture amount\" \"a\"\n");
  EXPECT_NE(mixed.status().message().find(
                "scene.pbrt:3: the texture \"a\" is no float texture; define it as \"float\""),
            std::string::npos)
      << mixed.status();
}

TEST(Version3, FactorsOfLightsAndAnglesOfCamerasAreKept) {
  const PbrtScene scene = MustRead(R"(
    Camera "perspective" "float halffov" [ 20 ]
    WorldBegin
    LightSource "point" "blackbody I" [ 5500 3 ]
    LightSource "point" "blackbody I" [ 5500 ] "float scale" 3)");
  EXPECT_EQ(scene.scene.camera.fov, 40);
  ASSERT_EQ(scene.scene.lights.size(), 2u);
  const auto intensity = [&](size_t i) {
    return std::get<PointLightDescription>(scene.scene.lights[i].light).intensity;
  };
  EXPECT_EQ(intensity(0), intensity(1));
  EXPECT_GT(intensity(0).r, 0);
  EXPECT_TRUE(Warns(scene, "pbrt-v3's second number of a \"blackbody\""));
}

TEST(Version3, WhatHasNoWordIsRefusedWithWhatToUse) {
  const auto message = [](const std::string& text) {
    return std::string(ReadWorld(text).status().message());
  };
  EXPECT_EQ(message("Material \"disney\""),
            "scene.pbrt:2: Material \"disney\" of pbrt-v3 is not supported; use diffuse, "
            "conductor, dielectric or a mix");
  EXPECT_EQ(message("\nShape \"hyperboloid\""),
            "scene.pbrt:3: Shape \"hyperboloid\" of pbrt-v3 is not supported; use a trianglemesh");
  EXPECT_NE(message("LightSource \"infinite\" \"string mapname\" \"sky.exr\" \"rgb L\" [ 1 2 3 ]")
                .find("use a gray one"),
            std::string::npos);
  EXPECT_NE(message("WorldEnd\nWorldBegin").find("last of the file"), std::string::npos);
  EXPECT_NE(message("Material \"mix\" \"string namedmaterial1\" \"a\"").find("namedmaterial2"),
            std::string::npos);
}

TEST(Version3, MaterialsOfVersion4ThatAreNotReadSaySo) {
  for (const char* type : {"subsurface", "measured", "hair"}) {
    const std::string message(
        ReadWorld(std::string("\nMaterial \"") + type + "\"").status().message());
    EXPECT_EQ(message.rfind("scene.pbrt:3: ", 0), 0u) << message;
    EXPECT_NE(message.find("not supported; use"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace strata
