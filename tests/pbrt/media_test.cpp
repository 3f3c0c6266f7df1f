#include <gtest/gtest.h>

#include "tests/pbrt/parsed_scene.h"

// Media of pbrt files and what shapes and the camera make of MediumInterface.

namespace strata {
namespace {

std::string ErrorOf(const std::string& world) {
  return std::string(ReadText("WorldBegin\n" + world).status().message());
}

TEST(Media, HavePbrtsParametersAndDefaults) {
  const PbrtScene scene = World(R"(
    MakeNamedMedium "milk" "string type" "homogeneous"
    MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [1 2 3] "rgb sigma_s" [4 5 6]
      "float scale" 0.5 "float g" -0.25 "rgb Le" [1 2 3] "float Lescale" 2
    MakeNamedMedium "drink" "string type" "homogeneous" "string preset" "Coke" "float scale" 10)");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& media = scene.scene.media;
  ASSERT_EQ(media.size(), 3u);
  EXPECT_EQ(media[0].scattering, (Rgb{2.55f, 3.21f, 3.77f}));
  EXPECT_EQ(media[0].absorption, (Rgb{0.0011f, 0.0024f, 0.014f}));
  EXPECT_EQ(media[0].g, 0);
  EXPECT_EQ(media[0].emission, Rgb{});
  EXPECT_EQ(media[1].absorption, (Rgb{0.5f, 1, 1.5f}));
  EXPECT_EQ(media[1].scattering, (Rgb{2, 2.5f, 3}));
  EXPECT_EQ(media[1].g, -0.25f);
  EXPECT_EQ(media[1].emission, (Rgb{2, 4, 6}));
  EXPECT_EQ(media[2].scattering, (Rgb{0.7143f, 1.1688f, 1.7169f}) * 10.0f);
}

TEST(Media, LieWhereTheInterfaceSays) {
  const PbrtScene scene = Read(R"(
    MediumInterface "" "fog"
    Camera "perspective"
    WorldBegin
    Shape "sphere"
    AttributeBegin
      MediumInterface "milk" "fog"
      Shape "sphere"
      MediumInterface "milk"
      Shape "sphere"
      MediumInterface "fog" ""
      ObjectBegin "ball"
        Shape "sphere"
      ObjectEnd
      ObjectInstance "ball"
    AttributeEnd
    MediumInterface "" ""
    Shape "sphere"
    MakeNamedMedium "milk" "string type" "homogeneous"
    MakeNamedMedium "fog" "string type" "homogeneous")");
  EXPECT_EQ(scene.scene.media.size(), 2u);
  const MediumId fog = scene.scene.camera.medium;
  ASSERT_GE(fog, 0);
  const MediumId milk = 1 - fog;
  const auto border = [&](const ShapeDescription& shape) {
    return shape.border.value_or(MediumBorder{7, 7});
  };
  const auto& shapes = scene.scene.shapes;
  EXPECT_EQ(border(shapes.at(0)), (MediumBorder{kNoMedium, fog}));
  EXPECT_EQ(border(shapes.at(1)), (MediumBorder{milk, fog}));
  EXPECT_FALSE(shapes.at(2).border) << "parts milk from milk";
  EXPECT_FALSE(shapes.at(3).border);
  EXPECT_EQ(border(scene.scene.objects.at(0).shapes.at(0)), (MediumBorder{fog, kNoMedium}));
}

TEST(Media, ThatAreNotTheSameEverywhereAreLeftOutWithAWarning) {
  const PbrtScene scene = World(R"(
    MakeNamedMedium "smoke" "string type" "uniformgrid" "integer nx" 2 "float density" [1 2]
    MediumInterface "smoke" ""
    Shape "sphere")");
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].text,
            "media of type \"uniformgrid\" are not supported, only \"homogeneous\"; \"smoke\" is "
            "left out, as if it were clear");
  EXPECT_EQ(scene.warnings[0].where.line, 3);
}

TEST(Media, ErrorsAreLocated) {
  EXPECT_EQ(ErrorOf("MediumInterface \"tea\" \"\"\n"),
            "scene.pbrt:2: there is no medium \"tea\"; define it with MakeNamedMedium");
  EXPECT_EQ(ErrorOf("MakeNamedMedium \"tea\"\n"),
            "scene.pbrt:2: MakeNamedMedium \"tea\" wants a \"string type\"");
  EXPECT_EQ(ErrorOf("MakeNamedMedium \"tea\" \"string type\" \"homogenous\"\n"),
            "scene.pbrt:2: there is no medium of type \"homogenous\"");
  const std::string tea = "MakeNamedMedium \"tea\" \"string type\" \"homogeneous\" ";
  EXPECT_EQ(ErrorOf(tea + "\n" + tea), "scene.pbrt:3: medium \"tea\" is defined twice");
  EXPECT_EQ(ErrorOf(tea + "\"float g\" 1"),
            "scene.pbrt:2: the \"g\" of a medium is 1; it must lie between -1 and 1");
  EXPECT_EQ(ErrorOf(tea + "\"float scale\" -1"),
            "scene.pbrt:2: the \"scale\" of a medium is negative");
  EXPECT_EQ(ErrorOf(tea + "\"string preset\" \"Tea\""),
            "scene.pbrt:2: there is no preset \"Tea\" of a medium; give \"sigma_a\" and "
            "\"sigma_s\" in its place");
  EXPECT_NE(ErrorOf(tea + "\"rgb sigma_s\" [1 -1 1]"), "");
}

}  // namespace
}  // namespace strata
