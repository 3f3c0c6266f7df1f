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
    MakeNamedMedium "drink" "string type" "homogeneous" "string preset" "Coke" "float scale" 10
    MediumInterface "milk" "fog"
    Shape "sphere"
    MediumInterface "drink" ""
    Shape "sphere")");
  EXPECT_TRUE(scene.warnings.empty());
  const auto& media = scene.scene.media;
  ASSERT_EQ(media.size(), 3u);
  EXPECT_EQ(media[0].scattering, Rgb::Gray(1));
  EXPECT_EQ(media[0].absorption, Rgb::Gray(1));
  EXPECT_EQ(media[0].g, 0);
  EXPECT_EQ(media[0].emission, Rgb{});
  EXPECT_EQ(media[1].absorption, (Rgb{0.5f, 1, 1.5f}));
  EXPECT_EQ(media[1].scattering, (Rgb{2, 2.5f, 3}));
  EXPECT_EQ(media[1].g, -0.25f);
  EXPECT_EQ(media[1].emission, (Rgb{2, 4, 6}));
  EXPECT_EQ(media[2].absorption, (Rgb{0.10014f, 0.16503f, 0.2468f}) * 10.0f);
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
  EXPECT_EQ(ErrorOf("MediumInterface \"zz\" \"\"\nMediumInterface \"aa\" \"\"\n"),
            "scene.pbrt:2: there is no medium \"zz\"; define it with MakeNamedMedium");
  EXPECT_EQ(ErrorOf(tea + "\"float g\" 1"),
            "scene.pbrt:2: the \"g\" of a medium is 1; it must lie between -1 and 1");
  EXPECT_EQ(ErrorOf(tea + "\"float scale\" -1"),
            "scene.pbrt:2: the \"scale\" of a medium is negative");
  EXPECT_EQ(ErrorOf(tea + "\"string preset\" \"Tea\""),
            "scene.pbrt:2: there is no preset \"Tea\" of a medium; give \"sigma_a\" and "
            "\"sigma_s\" in its place");
  EXPECT_NE(ErrorOf(tea + "\"rgb sigma_s\" [1 -1 1]"), "");
}

TEST(Media, ThatAreNowhereAreLeftOut) {
  const PbrtScene scene = World(R"(
    MakeNamedMedium "unused" "string type" "homogeneous"
    MakeNamedMedium "used" "string type" "homogeneous" "float g" 0.5
    MediumInterface "used" ""
    Shape "sphere")");
  ASSERT_EQ(scene.scene.media.size(), 1u);
  EXPECT_EQ(scene.scene.media[0].g, 0.5f);
  EXPECT_EQ(*scene.scene.shapes.at(0).border, (MediumBorder{0, kNoMedium}));
}

TEST(Media, MayBeWrittenAsInVersion3) {
  const PbrtScene scene = World(R"(
    MakeNamedMedium "fog" "string type" "homogeneous" "color sigma_s" [1 2 3]
    MediumInterface "fog" ""
    Shape "sphere"
    MakeNamedMedium "fog" "string type" "homogeneous" "color sigma_s" [4 5 6]
    MediumInterface "fog" ""
    Shape "sphere")");
  ASSERT_EQ(scene.scene.media.size(), 2u);
  EXPECT_EQ(scene.scene.media[0].scattering, (Rgb{1, 2, 3}));
  EXPECT_EQ(scene.scene.media[1].scattering, (Rgb{4, 5, 6}));
  EXPECT_FALSE(scene.warnings.empty());
}

TEST(Media, WideColoursHaveNoNegativeCoefficients) {
  const PbrtScene scene = World(R"(
    ColorSpace "rec2020"
    MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_a" [0 1 0]
    MediumInterface "fog" ""
    Shape "sphere")");
  EXPECT_EQ(scene.scene.media.at(0).absorption.r, 0);
  EXPECT_GT(scene.scene.media.at(0).absorption.g, 1);
}

TEST(Media, BordersHaveNoMasks) {
  const PbrtScene scene = World(R"(
    MakeNamedMedium "fog" "string type" "homogeneous"
    MediumInterface "fog" ""
    Material "interface"
    Shape "sphere" "float alpha" 0.5)");
  EXPECT_EQ(scene.scene.shapes.at(0).alpha, AlphaMask());
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].text,
            "the \"alpha\" of a shape of \"interface\" material is ignored");
}

}  // namespace
}  // namespace strata
