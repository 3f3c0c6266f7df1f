#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/pbrt/parsed_scene.h"

// What a sound file says of lights is what the scene holds; pbrt-v4's defaults where it says
// nothing.

namespace strata {
namespace {

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

}  // namespace
}  // namespace strata
