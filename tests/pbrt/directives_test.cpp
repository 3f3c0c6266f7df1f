#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/pbrt/parsed_scene.h"

// Transforms, attributes, tokens and objects of sound files.

namespace strata {
namespace {

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

TEST(Meshes, AreNotDisplacedWhichIsToldWithItsPlace) {
  const PbrtScene scene = World(R"(Shape "trianglemesh" "point3 P" [ 0 0 0 1 0 0 0 1 0 ]
    "texture displacement" "bumps")");
  EXPECT_EQ(scene.scene.shapes.size(), 1u);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_EQ(scene.warnings[0].where.line, 3);
  EXPECT_NE(scene.warnings[0].text.find("stays as it is"), std::string::npos);
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
