// What a sound file says is what the scene holds; pbrt-v4's defaults where it says nothing.

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

PbrtScene Read(const std::string& text) {
  absl::StatusOr<PbrtScene> scene = ReadText(text);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *std::move(scene) : PbrtScene();
}

PbrtScene World(const std::string& world) { return Read("WorldBegin\n" + world); }

/// The value of a constant texture.
Rgb Constant(const PbrtScene& scene, TextureId id) {
  return std::get<ConstantTexture>(scene.scene.textures.at(id)).value;
}

template <typename T>
T MaterialOf(const PbrtScene& scene, size_t id = 1) {
  return std::get<T>(scene.scene.materials.at(id));
}

template <typename T>
T LightOf(const PbrtScene& scene) {
  return std::get<T>(scene.scene.lights.at(0).light);
}

TEST(EmptyWorld, HasPbrtsDefaults) {
  const PbrtScene scene = World("");
  const FrameDefaults& frame = scene.scene.defaults;
  EXPECT_EQ(frame.width, 1280);
  EXPECT_EQ(frame.height, 720);
  EXPECT_EQ(frame.max_depth, 5);
  EXPECT_EQ(frame.spp, 16u);
  EXPECT_EQ(frame.filter, DefaultFilter(FilterKind::kGaussian));
  EXPECT_FALSE(frame.crop.has_value());
  EXPECT_EQ(scene.scene.camera.fov, 90);
  EXPECT_EQ(scene.scene.camera.camera_to_world, Transform());
  ASSERT_EQ(scene.scene.materials.size(), 1u);
  EXPECT_EQ(Constant(scene, MaterialOf<DiffuseMaterial>(scene, 0).reflectance), Rgb::Gray(0.5f));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Frame, IsReadWithAllItsParameters) {
  const PbrtScene scene = Read(R"(
    Film "rgb" "integer xresolution" 100 "integer yresolution" [ 50 ]
      "float cropwindow" [ 0.25 0.751 0 1 ]
    PixelFilter "mitchell" "float xradius" 3 "float B" 0.5
    Sampler "independent" "integer pixelsamples" 40
    Integrator "volpath" "integer maxdepth" 9
    Camera "perspective" "float fov" 30 "float lensradius" 0.1 "float focaldistance" 7
      "float frameaspectratio" 2 "float screenwindow" [ -2 2 -1 1 ]
    WorldBegin)");
  const FrameDefaults& frame = scene.scene.defaults;
  EXPECT_EQ(frame.width, 100);
  EXPECT_EQ(frame.height, 50);
  EXPECT_EQ(frame.crop, (PixelRect{25, 0, 76, 50}));  // pbrt rounds both up
  EXPECT_EQ(frame.filter.kind, FilterKind::kMitchell);
  EXPECT_EQ(frame.filter.radius_x, 3);
  EXPECT_EQ(frame.filter.radius_y, 2);
  EXPECT_EQ(frame.filter.b, 0.5);
  EXPECT_EQ(frame.sampler, SamplerKind::kIndependent);
  EXPECT_EQ(frame.spp, 40u);
  EXPECT_EQ(frame.max_depth, 9);
  EXPECT_EQ(scene.scene.camera.fov, 30);
  EXPECT_FLOAT_EQ(scene.scene.camera.lens_radius, 0.1f);
  EXPECT_EQ(scene.scene.camera.focal_distance, 7);
  EXPECT_EQ(scene.scene.camera.frame_aspect, 2);
  EXPECT_EQ(scene.scene.camera.screen_window, (std::array<float, 4>{-2, 2, -1, 1}));
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Frame, OfUnknownPartsWarns) {
  const PbrtScene scene = Read(R"(
    Sampler "pmj02bn"
    Integrator "bdpt" "bool whatever" true
    PixelFilter "sinc" "float tau" 3
    Film "gbuffer" "float iso" 200
    Option "bool disablepixeljitter" true
    WorldBegin)");
  ASSERT_EQ(scene.warnings.size(), 6u);
  EXPECT_EQ(scene.warnings[0].where.ToString(), "scene.pbrt:2");
  EXPECT_NE(scene.warnings[0].text.find("pmj02bn"), std::string::npos);
}

TEST(Frame, HasTheSamplerOfItsName) {
  const std::pair<const char*, SamplerKind> samplers[] = {
      {"\"halton\"", SamplerKind::kHalton},
      {"\"halton\" \"string randomization\" \"owen\"", SamplerKind::kHalton},
      {"\"halton\" \"string randomization\" \"none\"", SamplerKind::kHaltonPlain},
      {"\"halton_plain\"", SamplerKind::kHaltonPlain},
      {"\"stratified\" \"integer xsamples\" 8", SamplerKind::kStratified},
      {"\"latin_hypercube\"", SamplerKind::kLatinHypercube},
      {"\"poisson_disk\"", SamplerKind::kPoissonDisk},
      {"\"drand48\"", SamplerKind::kDrand48},
  };
  for (const auto& [text, kind] : samplers) {
    const PbrtScene scene = Read(std::string("Sampler ") + text + " WorldBegin");
    EXPECT_EQ(scene.scene.defaults.sampler, kind) << text;
    EXPECT_TRUE(scene.warnings.empty()) << text;
  }
  EXPECT_EQ(Read("Sampler \"stratified\" \"bool jitter\" false WorldBegin").warnings.size(), 1u);
}

TEST(Frame, OfOtherRandomizationsWarns) {
  for (const char* known : {"none", "permutedigits"}) {
    const PbrtScene scene = Read(std::string("Sampler \"sobol\" \"string randomization\" \"") +
                                 known + "\" WorldBegin");
    EXPECT_EQ(scene.warnings.size(), 1u) << known;
  }
  EXPECT_TRUE(
      Read("Sampler \"sobol\" \"string randomization\" \"owen\" WorldBegin").warnings.empty());
}

TEST(Camera, LooksWhereLookAtSays) {
  const PbrtScene scene = Read(
      "LookAt 1 2 3  1 2 10  0 5 0\nCamera \"perspective\"\nWorldBegin\n"
      "CoordSysTransform \"camera\" Shape \"sphere\"");
  const Transform& to_world = scene.scene.camera.camera_to_world;
  const Vec3d eye = to_world.Point({0, 0, 0}), ahead = to_world.Point({0, 0, 1}),
              right = to_world.Point({1, 0, 0}), up = to_world.Point({0, 1, 0});
  EXPECT_EQ(Vec3f({float(eye.x), float(eye.y), float(eye.z)}), (Vec3f{1, 2, 3}));
  EXPECT_EQ(ahead.z, 4);
  EXPECT_EQ(right.x, 2);  // pbrt's camera space is left-handed
  EXPECT_EQ(up.y, 3);
  EXPECT_EQ(scene.scene.shapes.at(0).to_world, to_world);
}

TEST(Transforms, ActFromTheLastToTheFirst) {
  const PbrtScene scene = World(R"(
    AttributeBegin
      Translate 1 2 3 Scale 2 2 2 Rotate 90 0 0 1
      Shape "sphere"
      CoordinateSystem "there"
    AttributeEnd
    Shape "sphere"
    TransformBegin
      CoordSysTransform "there"
      ReverseOrientation
      Shape "sphere"
    TransformEnd
    Transform [ 1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1 ]
    Shape "sphere"
    Identity ConcatTransform [ 1 0 0 0 0 1 0 0 0 0 1 0 4 5 6 1 ]
    Shape "sphere")");
  const auto& shapes = scene.scene.shapes;
  ASSERT_EQ(shapes.size(), 5u);
  const Vec3d p = shapes[0].to_world.Point({1, 0, 0});
  EXPECT_EQ(p.x, 1);
  EXPECT_EQ(p.y, 4);
  EXPECT_EQ(p.z, 3);
  EXPECT_EQ(shapes[1].to_world, Transform());
  EXPECT_EQ(shapes[2].to_world, shapes[0].to_world);
  EXPECT_TRUE(shapes[2].reverse_orientation);
  // TransformEnd brings back the transform alone.
  EXPECT_TRUE(shapes[3].reverse_orientation);
  EXPECT_EQ(shapes[3].to_world, Transform::Translate(7, 8, 9));
  EXPECT_EQ(shapes[4].to_world, Transform::Translate(4, 5, 6));
}

TEST(Transforms, AreInvertedAndKeepTheirHand) {
  const Transform t =
      Transform::Translate(1, 2, 3) * Transform::Rotate(40, 1, 2, 3) * Transform::Scale(2, 3, -4);
  const Transform product = t * *t.Inverse();
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) EXPECT_NEAR(product.m[i][j], i == j, 1e-15);
  }
  EXPECT_TRUE(t.SwapsHandedness());
  EXPECT_FALSE(Transform::Rotate(40, 1, 2, 3).SwapsHandedness());
  EXPECT_FALSE(Transform::Scale(1, 0, 1).Inverse().has_value());
  EXPECT_EQ(t.Transposed().Transposed(), t);
  // A normal stays perpendicular to what it was perpendicular to.
  const Vec3d n = Transform::Normal(*t.Inverse(), {0, 0, 1}), v = t.Vector({1, 1, 0});
  EXPECT_NEAR(n.x * v.x + n.y * v.y + n.z * v.z, 0, 1e-14);
}

TEST(Attributes, EndWithTheirScopeAndYieldToTheShapesOwn) {
  const PbrtScene scene = World(R"(
    AttributeBegin
      Attribute "shape" "float radius" 3 "float zmax" 1
      Shape "sphere"
      Shape "sphere" "float radius" 2
      Shape "cylinder" "float zmin" 0
    AttributeEnd
    Shape "sphere")");
  const auto sphere = [&](int i) { return std::get<SphereShape>(scene.scene.shapes[i].geometry); };
  EXPECT_EQ(sphere(0).radius, 3);
  EXPECT_EQ(sphere(0).z_max, 1);
  EXPECT_EQ(sphere(0).z_min, -3);
  EXPECT_EQ(sphere(1).radius, 2);
  EXPECT_EQ(sphere(3).radius, 1);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Parameters, ThatNobodyKnowsAreToldOnceWithACount) {
  const PbrtScene scene =
      World("Shape \"sphere\"\n \"float radios\" 2\nShape \"sphere\" \"float radios\" 3");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].where.ToString(), "scene.pbrt:3");
  EXPECT_EQ(scene.warnings[0].text,
            "Shape \"sphere\" does not know parameter \"float radios\"; it is ignored (2 times)");
}

TEST(Tokens, MayStandWithoutSpaceAndBesideComments) {
  const PbrtScene scene = World(
      "Shape\"disk\"\"float radius\"[2]#a comment\n\"float height\"+.5e1#\n# another \"comment\" "
      "[");
  const DiskShape disk = std::get<DiskShape>(scene.scene.shapes.at(0).geometry);
  EXPECT_EQ(disk.radius, 2);
  EXPECT_EQ(disk.height, 5);
}

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

TEST(AreaLights, MayPrecedeTheirMaterialToo) {
  const PbrtScene scene = World(R"(
    AreaLightSource "diffuse"
    NamedMaterial "solid" Shape "sphere"
    NamedMaterial "border" Shape "sphere"
    MakeNamedMaterial "solid" "string type" "diffuse"
    MakeNamedMaterial "border" "string type" "interface")");
  EXPECT_TRUE(scene.scene.shapes.at(0).emission.has_value());
  EXPECT_FALSE(scene.scene.shapes.at(1).emission.has_value());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].where.line, 5);
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

TEST(Lights, StandInTheWorld) {
  const auto point = LightOf<PointLightDescription>(
      World("Translate 1 2 3 LightSource \"point\" \"point3 from\" [ 0 0 1 ] \"rgb I\" [ 1 2 3 ] "
            "\"float scale\" 2"));
  EXPECT_EQ(point.position, (Vec3d{1, 2, 4}));
  EXPECT_EQ(point.intensity, (Rgb{2, 4, 6}));
  // Power is spread over the sphere of directions.
  const auto powered =
      LightOf<PointLightDescription>(World("LightSource \"point\" \"float power\" 12.566371"));
  EXPECT_NEAR(powered.intensity.g, 1, 1e-6);

  const auto distant = LightOf<DistantLightDescription>(World(
      "Rotate 90 0 0 1 LightSource \"distant\" \"point3 from\" [ 2 0 0 ] \"point3 to\" [ 0 0 0 ] "
      "\"float illuminance\" 3"));
  EXPECT_EQ(distant.direction, (Vec3f{0, 1, 0}));
  EXPECT_EQ(distant.irradiance, Rgb::Gray(3));
}

TEST(Lights, SpotsAreReadInTheirSpace) {
  const PbrtScene scene = World(R"(
    Translate 0 0 5
    Rotate 90 0 1 0
    LightSource "spot" "rgb I" [ 1 2 3 ] "float scale" 2 "point3 from" [ 1 0 0 ]
      "point3 to" [ 1 0 3 ] "float coneangle" 40 "float conedeltaangle" 10
    LightSource "spot" "float power" 100
    LightSource "spot" "float coneangle" 10 "float conedeltaangle" 25)");
  const auto spot = LightOf<SpotLightDescription>(scene);
  EXPECT_NEAR(spot.position.z, 4, 1e-12);
  EXPECT_NEAR(spot.direction.x, 1, 1e-6);
  EXPECT_EQ(spot.cone_angle, 40);
  EXPECT_EQ(spot.falloff_start, 30);
  EXPECT_EQ(spot.intensity, (Rgb{2, 4, 6}));
  const auto& powered = std::get<SpotLightDescription>(scene.scene.lights.at(1).light);
  EXPECT_EQ(powered.cone_angle, 30);
  EXPECT_EQ(powered.falloff_start, 25);
  // pbrt-v4: 2 pi ((1 - cos 25) + (cos 25 - cos 30) / 2) for an intensity of 1.
  const double pi = std::acos(-1.0), full = std::cos(25 * pi / 180), none = std::cos(30 * pi / 180);
  EXPECT_NEAR(powered.intensity.g, 100 / (2 * pi * ((1 - full) + (full - none) / 2)), 1e-3);
  EXPECT_EQ(std::get<SpotLightDescription>(scene.scene.lights.at(2).light).falloff_start, 0);
}

TEST(Lights, OfFilesAreReadAndBundled) {
  SceneFolder folder;
  folder.Write("maps/slide.png", "never opened here");
  folder.Write("maps/lamp.ies", "nor is this");
  folder.Write("scene.pbrt", R"(WorldBegin
    Translate 1 2 3
    LightSource "projection" "string filename" "maps/slide.png" "float fov" 30 "float scale" 4
    LightSource "goniometric" "string filename" "maps/lamp.ies" "rgb I" [ 1 2 3 ] "float power" 9
      "float scale" 2)");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_TRUE(scene->warnings.empty());
  EXPECT_EQ(scene->files,
            (std::vector<std::string>{"maps/lamp.ies", "maps/slide.png", "scene.pbrt"}));
  const auto projection = LightOf<ProjectionLightDescription>(*scene);
  EXPECT_EQ(projection.path, "maps/slide.png");
  EXPECT_EQ(projection.to_world, Transform::Translate(1, 2, 3));
  EXPECT_EQ(projection.fov, 30);
  EXPECT_EQ(projection.scale, 4);
  EXPECT_FALSE(projection.power.has_value());
  const auto& lamp = std::get<GoniometricLightDescription>(scene->scene.lights.at(1).light);
  EXPECT_EQ(lamp.path, "maps/lamp.ies");
  EXPECT_EQ(lamp.intensity, (Rgb{2, 4, 6}));
  EXPECT_EQ(lamp.power, 9);
}

TEST(Lights, OfTheSkyMayHaveAPortalInTheWorld) {
  SceneFolder folder;
  folder.Write("sky.exr", "never opened here");
  folder.Write("scene.pbrt", R"(WorldBegin
    Translate 1 2 3
    LightSource "infinite" "string filename" "sky.exr"
      "point3 portal" [ 0 0 0  0 1 0  1 1 0  1 0 0 ]
    LightSource "infinite" "point3 portal" [ 0 0 0  0 1 0  1 1 0  1 0 0 ])");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  const auto sky = LightOf<ImageInfiniteLightDescription>(*scene);
  ASSERT_TRUE(sky.portal.has_value());
  EXPECT_EQ((*sky.portal)[2].x, 1);
  EXPECT_EQ((*sky.portal)[2].z, 0);
  ASSERT_EQ(scene->warnings.size(), 1u);
  EXPECT_NE(scene->warnings[0].text.find("portal"), std::string::npos);
}

TEST(AreaLights, GiveTheirRadianceToTheShapesOfTheirScope) {
  const PbrtScene scene = World(R"(
    AttributeBegin
      AreaLightSource "diffuse" "rgb L" [ 1 2 3 ] "float scale" 2 "bool twosided" true
      Shape "sphere" Shape "disk"
      Material "interface" Shape "disk"
    AttributeEnd
    Shape "sphere"
    AreaLightSource "diffuse" "rgb L" [ 0 0 0 ]
    Shape "sphere"
    ObjectBegin "o" AreaLightSource "diffuse" Shape "disk" ObjectEnd ObjectInstance "o")");
  const auto& shapes = scene.scene.shapes;
  ASSERT_EQ(shapes.size(), 5u);
  EXPECT_EQ(shapes[0].emission->radiance, (Rgb{2, 4, 6}));
  EXPECT_TRUE(shapes[1].emission->two_sided);
  for (const int dark : {2, 3, 4}) EXPECT_FALSE(shapes[dark].emission.has_value()) << dark;
  EXPECT_FALSE(scene.scene.objects.at(0).shapes.at(0).emission.has_value());
  EXPECT_EQ(scene.warnings.size(), 2u);
}

TEST(AreaLights, OfAPowerHaveTheRadianceThatGivesIt) {
  const double pi = std::acos(-1.0);
  const auto radiance = [](const std::string& shape) {
    return World("AreaLightSource \"diffuse\" \"float power\" 100 " + shape)
        .scene.shapes.at(0)
        .emission->radiance.g;
  };
  EXPECT_NEAR(radiance("Scale 3 3 3 Shape \"sphere\""), 100 / (pi * 36 * pi), 1e-5);
  EXPECT_NEAR(radiance("Shape \"disk\" \"float innerradius\" 0.5"), 100 / (pi * 0.75 * pi), 1e-4);
  EXPECT_NEAR(radiance("Scale 1 2 1 Shape \"trianglemesh\" \"point3 P\" [ 0 0 0 1 0 0 0 1 0 ]"),
              100 / (pi * 1), 1e-4);
}

/// Two by one linear pixels of gray 1 and 3.
std::string TwoPixels() {
  std::string bytes = "PF\n2 1\n-1.0\n";
  for (const float value : {1.0f, 1.0f, 1.0f, 3.0f, 3.0f, 3.0f})
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  return bytes;
}

TEST(AreaLights, TakeAnImage) {
  SceneFolder folder;
  folder.Write("maps/two.pfm", TwoPixels());
  folder.Write("scene.pbrt", R"(WorldBegin
    Texture "unused" "spectrum" "imagemap" "string filename" "gone.png"
    AreaLightSource "diffuse" "string filename" "maps/two.pfm" "float scale" 5
    Shape "disk"
    AreaLightSource "diffuse" "string filename" "maps/two.pfm" "float power" 100
      "bool twosided" true
    Shape "disk")");
  const absl::StatusOr<PbrtScene> scene = folder.Read();
  ASSERT_TRUE(scene.ok()) << scene.status();
  EXPECT_EQ(scene->files, (std::vector<std::string>{"maps/two.pfm", "scene.pbrt"}));
  EXPECT_TRUE(scene->warnings.empty());
  const AreaEmission& scaled = *scene->scene.shapes.at(0).emission;
  EXPECT_EQ(scaled.radiance, Rgb::Gray(5));
  const auto& image = std::get<ImageTexture>(scene->scene.textures.at(scaled.texture));
  EXPECT_EQ(image.path, "maps/two.pfm");
  EXPECT_EQ(image.wrap, ImageWrap::kClamp);
  EXPECT_EQ(image.where.ToString(), "scene.pbrt:3");
  // A power is that of the image's mean, 2, from both sides.
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(scene->scene.shapes.at(1).emission->radiance.g, 100 / (2 * pi * pi) / 2, 1e-5);
}

TEST(Objects, HoldTheirShapesAndAreInstancedInPlace) {
  const PbrtScene scene = World(R"(
    Translate 1 0 0
    ObjectInstance "later"
    ObjectBegin "later" Scale 2 2 2 Shape "sphere" ObjectEnd
    AttributeBegin Translate 0 1 0 ObjectInstance "later" AttributeEnd
    Shape "disk")");
  ASSERT_EQ(scene.scene.objects.size(), 1u);
  EXPECT_EQ(scene.scene.objects[0].shapes.at(0).to_world,
            Transform::Translate(1, 0, 0) * Transform::Scale(2, 2, 2));
  ASSERT_EQ(scene.scene.instances.size(), 2u);
  EXPECT_EQ(scene.scene.instances[1].to_world, Transform::Translate(1, 1, 0));
  EXPECT_EQ(scene.scene.shapes.at(0).to_world, Transform::Translate(1, 0, 0));
}

TEST(Meshes, NeedNoIndicesForASinglePrimitive) {
  const PbrtScene scene = World(R"(
    Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ]
    Shape "bilinearmesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 1 1 0 ])");
  EXPECT_EQ(std::get<TriangleMeshShape>(scene.scene.shapes.at(0).geometry).triangles.size(), 1u);
  EXPECT_EQ(std::get<BilinearPatchShape>(scene.scene.shapes.at(1).geometry).patches.at(0),
            (std::array<uint32_t, 4>{0, 1, 2, 3}));
}

TEST(Meshes, CutAwayByAlphaAreLeftOutUnlessTheyEmit) {
  const PbrtScene scene = World(R"(
    Texture "holes" "float" "checkerboard"
    Shape "sphere" "float alpha" 0
    Shape "sphere" "float alpha" 1
    Shape "sphere" "texture alpha" "holes"
    AreaLightSource "diffuse" Shape "sphere" "float alpha" 0)");
  ASSERT_EQ(scene.scene.shapes.size(), 3u);
  EXPECT_EQ(scene.scene.shapes[0].alpha.texture, kNoTexture);
  const TextureId holes = scene.scene.shapes[1].alpha.texture;
  ASSERT_NE(holes, kNoTexture);
  EXPECT_TRUE(std::holds_alternative<CheckerboardTexture>(scene.scene.textures.at(holes)));
  EXPECT_EQ(scene.scene.shapes[2].alpha.texture, kNoTexture);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].text.find("not seen"), std::string::npos);
}

}  // namespace
}  // namespace strata
