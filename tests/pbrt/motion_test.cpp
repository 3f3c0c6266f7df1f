#include <gtest/gtest.h>

#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

PbrtScene MustRead(const std::string& text) {
  absl::StatusOr<PbrtScene> scene = ReadText(text);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *std::move(scene) : PbrtScene{};
}

TEST(Motion, DirectivesChangeTheActiveTransformsAlone) {
  const PbrtScene scene = MustRead(R"(WorldBegin
    ObjectBegin "o" Shape "sphere" ObjectEnd
    AttributeBegin
      Translate 1 0 0
      ActiveTransform EndTime Translate 0 2 0
      ActiveTransform StartTime Scale 3 3 3
      ActiveTransform All Translate 0 0 5
      ObjectInstance "o"
    AttributeEnd
    ObjectInstance "o")");
  ASSERT_EQ(scene.scene.instances.size(), 2u);
  const InstanceDescription& moving = scene.scene.instances[0];
  EXPECT_EQ(moving.to_world, Transform::Translate(1, 0, 0) * Transform::Scale(3, 3, 3) *
                                 Transform::Translate(0, 0, 5));
  EXPECT_EQ(moving.to_world_at_end, Transform::Translate(1, 2, 5));
  EXPECT_FALSE(scene.scene.instances[1].to_world_at_end.has_value());
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(Motion, ScopesRestoreWhichTransformsAreActive) {
  const PbrtScene scene = MustRead(R"(WorldBegin
    AttributeBegin ActiveTransform EndTime AttributeEnd
    TransformBegin ActiveTransform StartTime Translate 1 0 0 TransformEnd
    Translate 0 0 1
    CoordinateSystem "here"
    ActiveTransform EndTime Translate 0 7 0 CoordSysTransform "here"
    Shape "sphere")");
  ASSERT_EQ(scene.scene.shapes.size(), 1u);
  EXPECT_EQ(scene.scene.shapes[0].to_world, Transform::Translate(0, 0, 1));
  EXPECT_TRUE(scene.scene.instances.empty());
}

TEST(Motion, ShapesThatMoveAlikeShareAnObject) {
  const PbrtScene scene = MustRead(R"(WorldBegin
    Shape "sphere"
    AttributeBegin
      ActiveTransform EndTime Translate 1 0 0 ActiveTransform All
      Shape "sphere"
      AttributeBegin Material "conductor" Shape "disk" AttributeEnd
      Rotate 10 0 0 1
      Shape "cylinder"
    AttributeEnd)");
  EXPECT_EQ(scene.scene.shapes.size(), 1u);
  ASSERT_EQ(scene.scene.instances.size(), 2u);
  ASSERT_EQ(scene.scene.objects.size(), 2u);
  EXPECT_EQ(scene.scene.objects[scene.scene.instances[0].object].shapes.size(), 2u);
  EXPECT_EQ(scene.scene.objects[0].shapes[1].to_world, Transform{});
  EXPECT_EQ(scene.scene.instances[0].to_world_at_end, Transform::Translate(1, 0, 0));
  EXPECT_EQ(scene.scene.instances[1].to_world, Transform::Rotate(10, 0, 0, 1));
}

TEST(Motion, ObjectsOfTheFileKeepTheirPlacesBesideThoseThatAreMade) {
  const PbrtScene scene = MustRead(R"(WorldBegin
    ObjectInstance "later"
    AttributeBegin ActiveTransform EndTime Translate 1 0 0 Shape "disk" AttributeEnd
    ObjectBegin "later" Shape "sphere" ObjectEnd
    ObjectBegin "other" Shape "cylinder" ObjectEnd
    ObjectInstance "other")");
  ASSERT_EQ(scene.scene.instances.size(), 3u);
  const auto shape_of = [&](int instance) {
    return scene.scene.objects[scene.scene.instances[instance].object]
        .shapes.at(0)
        .geometry.index();
  };
  EXPECT_EQ(shape_of(0), ShapeGeometry(SphereShape{}).index());
  EXPECT_EQ(shape_of(1), ShapeGeometry(DiskShape{}).index());
  EXPECT_EQ(shape_of(2), ShapeGeometry(CylinderShape{}).index());
}

TEST(Motion, CamerasMoveAndTheirShutterIsATimeOfMotion) {
  const PbrtScene scene = MustRead(R"(TransformTimes 2 6
    ActiveTransform EndTime Translate 0 0 -3 ActiveTransform All
    Camera "perspective" "float shutteropen" 3 "float shutterclose" 4
    WorldBegin)");
  const CameraDescription& camera = scene.scene.camera;
  EXPECT_EQ(camera.camera_to_world, Transform{});
  EXPECT_EQ(camera.camera_to_world_at_end, Transform::Translate(0, 0, 3));
  EXPECT_EQ(camera.shutter_open, 0.25f);
  EXPECT_EQ(camera.shutter_close, 0.5f);
}

TEST(Motion, WhatCannotMoveIsWarnedOf) {
  const PbrtScene scene = MustRead(R"(WorldBegin
    ActiveTransform EndTime Translate 0 0 -3
    LightSource "point"
    ObjectBegin "o" Shape "sphere" ObjectEnd
    AttributeBegin AreaLightSource "diffuse" Shape "sphere" AttributeEnd
    ObjectInstance "o")");
  ASSERT_EQ(scene.warnings.size(), 3u);
  EXPECT_EQ(scene.warnings[0].text, "a light cannot move; it stays where it is at the start");
  EXPECT_EQ(scene.warnings[1].text,
            "a shape of an object cannot move; it stays where it is at the start");
  EXPECT_EQ(scene.warnings[2].text,
            "area lights that move are not supported; the shape does not emit");
  EXPECT_FALSE(scene.scene.objects.back().shapes.at(0).emission.has_value());
}

TEST(Motion, TimesThatMakeNoneAreRefused) {
  EXPECT_EQ(ReadText("TransformTimes 1 1\nWorldBegin").status().message(),
            "scene.pbrt:1: TransformTimes wants a start before the end");
  EXPECT_EQ(ReadText("Camera \"perspective\" \"float shutteropen\" 2\nWorldBegin")
                .status()
                .message()
                .rfind("scene.pbrt:1: \"shutterclose\"", 0),
            0u);
  EXPECT_EQ(ReadWorld("ActiveTransform Sometimes").status().message(),
            "scene.pbrt:2: ActiveTransform wants All, StartTime or EndTime");
}

}  // namespace
}  // namespace strata
