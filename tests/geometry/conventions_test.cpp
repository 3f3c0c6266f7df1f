#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"

// Orientation, parametrization and what happens to bad shapes, as pbrt-v4 has it.

namespace strata::testing {
namespace {

TriangleMeshShape OneTriangle() {
  TriangleMeshShape mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

SurfacePoint PointFromAbove(const Geometry& geometry, float x, float y) {
  const Ray ray = {{x, y, 5}, {0, 0, -1}};
  Hit hit;
  EXPECT_TRUE(geometry.Intersect(ray, &hit));
  return geometry.Surface(ray, hit);
}

TEST(Conventions, TrianglesFaceTheSideOfTheirWinding) {
  ShapeDescription shape = Shape(OneTriangle());
  EXPECT_EQ(PointFromAbove(*MustBuild(shape), 0.25f, 0.25f).ng.z, 1);
  shape.reverse_orientation = true;
  EXPECT_EQ(PointFromAbove(*MustBuild(shape), 0.25f, 0.25f).ng.z, -1);
  // A mirror turns the winding round, and the side with it: the outside stays outside.
  shape.reverse_orientation = false;
  shape.to_world = Transform::Scale(-1, 1, 1);
  EXPECT_EQ(PointFromAbove(*MustBuild(shape), -0.25f, 0.25f).ng.z, 1);
}

TEST(Conventions, VertexNormalsTellTheSide) {
  TriangleMeshShape mesh = OneTriangle();
  mesh.normals = {{0.5f, 0, -1}, {0, 0, -2}, {0, 0.5f, -1}};
  ShapeDescription shape = Shape(mesh);
  const SurfacePoint point = PointFromAbove(*MustBuild(shape), 0.25f, 0.25f);
  EXPECT_EQ(point.ng.z, -1);
  EXPECT_GT(Dot(point.ng, point.ns), 0);
  EXPECT_NEAR(Length(point.ns), 1, 1e-6);
  const Vec3d n0 = Normalize(Vec3d{0.5, 0, -1}), n2 = Normalize(Vec3d{0, 0.5, -1});
  const Vec3d expected = Normalize(n0 * 0.5 + Vec3d{0, 0, -0.25} + n2 * 0.25);
  EXPECT_NEAR(point.ns.x, expected.x, 1e-6);
  EXPECT_NEAR(point.ns.y, expected.y, 1e-6);
  EXPECT_NEAR(point.ns.z, expected.z, 1e-6);
  shape.reverse_orientation = true;
  EXPECT_EQ(PointFromAbove(*MustBuild(shape), 0.25f, 0.25f).ng.z, 1);
}

TEST(Conventions, NormalsAreTransformedAsNormals) {
  TriangleMeshShape mesh = OneTriangle();
  const double r = std::sqrt(0.5);
  mesh.normals.assign(3, ToFloat({r, 0, r}));
  const SurfacePoint point =
      PointFromAbove(*MustBuild(Shape(mesh, Transform::Scale(2, 1, 1))), 0.5f, 0.25f);
  const Vec3d expected = Normalize(Vec3d{0.5, 0, 1});
  EXPECT_NEAR(point.ns.x, expected.x, 1e-6);
  EXPECT_NEAR(point.ns.z, expected.z, 1e-6);
}

TEST(Conventions, NormalsThatCancelFallBackToTheTriangles) {
  TriangleMeshShape mesh = OneTriangle();
  mesh.normals = {{1, 0, 0}, {-1, 0, 0}, {std::numeric_limits<float>::quiet_NaN(), 0, 0}};
  const SurfacePoint point = PointFromAbove(*MustBuild(Shape(mesh)), 1.0f / 3, 1.0f / 3);
  EXPECT_EQ(point.ns, point.ng);
}

TEST(Conventions, UvsOfTriangles) {
  // pbrt's default: (0,0), (1,0), (1,1).
  const SurfacePoint plain = PointFromAbove(*MustBuild(Shape(OneTriangle())), 0.25f, 0.5f);
  EXPECT_NEAR(plain.uv.x, 0.75, 1e-6);
  EXPECT_NEAR(plain.uv.y, 0.5, 1e-6);
  EXPECT_NEAR(plain.dpdu.x, 1, 1e-6);
  EXPECT_NEAR(plain.dpdu.y, 0, 1e-6);

  TriangleMeshShape mesh = OneTriangle();
  mesh.uvs = {{0.5f, 0}, {0.5f, 2}, {0, 0}};
  const SurfacePoint point = PointFromAbove(*MustBuild(Shape(mesh)), 0.25f, 0.5f);
  EXPECT_NEAR(point.uv.x, 0.5 * 0.25 + 0.5 * 0.25, 1e-6);
  EXPECT_NEAR(point.uv.y, 0.5, 1e-6);
  // u falls by 1/2 along y, so that dp/du = (0, -2, 0).
  EXPECT_NEAR(point.dpdu.x, 0, 1e-5);
  EXPECT_NEAR(point.dpdu.y, -2, 1e-5);

  mesh.uvs.assign(3, {0.5f, 0.5f});  // No parametrization at all.
  const SurfacePoint degenerate = PointFromAbove(*MustBuild(Shape(mesh)), 0.25f, 0.5f);
  EXPECT_EQ(degenerate.dpdu, Vec3f{});
}

TEST(Conventions, UvsMayStandAtAnyOffset) {
  // Three second uvs stand four places behind those of four vertices without any: the offset
  // between them would be that of a mesh without second uvs.
  TriangleMeshShape bare, mapped;
  bare.positions = {{-1, -1, 5}, {1, -1, 5}, {1, 1, 5}, {-1, 1, 5}};
  bare.triangles = {{0, 1, 2}, {0, 2, 3}};
  mapped.positions = {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}};
  mapped.triangles = {{0, 1, 2}};
  mapped.uvs.assign(3, {0.25f, 0.5f});
  mapped.second_uvs.assign(3, {0.75f, 1});
  SceneDescription scene = EmptyScene();
  scene.shapes = {Shape(bare), Shape(mapped)};
  const auto geometry = Geometry::Build(scene);
  ASSERT_TRUE(geometry.ok()) << geometry.status();
  const Ray ray = {{0, 0, -1}, {0, 0, 1}};
  Hit hit;
  ASSERT_TRUE((*geometry)->Intersect(ray, &hit));
  const SurfacePoint point = (*geometry)->Surface(ray, hit);
  EXPECT_EQ(point.uv, (Vec2f{0.25f, 0.5f}));
  EXPECT_EQ(point.second_uv, (Vec2f{0.75f, 1}));
}

TEST(Conventions, QuadricsFaceOutwardsAndAreParametrizedAsInPbrt) {
  const auto sphere = MustBuild(Shape(SphereShape{2, -2, 2, 360}));
  const Ray to_y = {{0, 5, 0}, {0, -1, 0}};
  Hit hit;
  ASSERT_TRUE(sphere->Intersect(to_y, &hit));
  SurfacePoint point = sphere->Surface(to_y, hit);
  EXPECT_NEAR(point.ng.y, 1, 1e-6);
  EXPECT_NEAR(point.uv.x, 0.25, 1e-6);
  EXPECT_NEAR(point.uv.y, 0.5, 1e-6);
  EXPECT_NEAR(point.dpdu.x, -2 * 2 * M_PI, 1e-4);

  const auto disk = MustBuild(Shape(DiskShape{1, 2, 0, 360}));
  point = PointFromAbove(*disk, 0, -1);
  EXPECT_NEAR(point.p.z, 1, 1e-6);
  EXPECT_EQ(point.ng.z, 1);
  EXPECT_NEAR(point.uv.x, 0.75, 1e-6);
  EXPECT_NEAR(point.uv.y, 0.5, 1e-6);

  const auto cylinder = MustBuild(Shape(CylinderShape{1, 0, 4, 180}));
  const Ray at_z1 = {{0, 5, 1}, {0, -1, 0}};
  ASSERT_TRUE(cylinder->Intersect(at_z1, &hit));
  point = cylinder->Surface(at_z1, hit);
  EXPECT_NEAR(point.ng.y, 1, 1e-6);
  EXPECT_NEAR(point.uv.x, 0.5, 1e-6);
  EXPECT_NEAR(point.uv.y, 0.25, 1e-6);

  ShapeDescription reversed = Shape(SphereShape{});
  reversed.reverse_orientation = true;
  EXPECT_EQ(PointFromAbove(*MustBuild(reversed), 0, 0).ng.z, -1);
  // Mirrors leave the outside of a quadric outside.
  EXPECT_EQ(PointFromAbove(*MustBuild(Shape(SphereShape{}, Transform::Scale(1, -1, 1))), 0, 0).ng.z,
            1);
}

TEST(Conventions, PatchesFaceTheCrossProductOfTheirParameters) {
  BilinearPatchShape patch;
  patch.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
  patch.patches = {{0, 1, 2, 3}};
  SurfacePoint point = PointFromAbove(*MustBuild(Shape(patch)), 0.25f, 0.75f);
  EXPECT_EQ(point.ng.z, 1);
  EXPECT_NEAR(point.uv.x, 0.25, 1e-6);
  EXPECT_NEAR(point.uv.y, 0.75, 1e-6);
  patch.uvs = {{0, 0}, {0, 2}, {1, 0}, {1, 2}};
  patch.normals.assign(4, {0, 0, -1});
  point = PointFromAbove(*MustBuild(Shape(patch)), 0.25f, 0.75f);
  EXPECT_EQ(point.ng.z, -1);
  EXPECT_EQ(point.ns.z, -1);
  EXPECT_NEAR(point.uv.x, 0.75, 1e-6);
  EXPECT_NEAR(point.uv.y, 0.5, 1e-6);
  EXPECT_NEAR(point.dpdu.y, 1, 1e-6);
}

TEST(Conventions, DegenerateTrianglesDoNoHarm) {
  TriangleMeshShape mesh = OneTriangle();
  mesh.positions.push_back({0.5f, 0, 0});
  mesh.triangles = {{0, 0, 1}, {0, 1, 3}, {0, 1, 2}, {2, 2, 2}};
  const auto geometry = MustBuild(Shape(mesh));
  EXPECT_EQ(geometry->triangle_count(), 1u);
  EXPECT_EQ(PointFromAbove(*geometry, 0.25f, 0.25f).ng.z, 1);
}

TEST(Conventions, InterfacesAreNoSurfaces) {
  SceneDescription scene = EmptyScene();
  scene.materials.push_back(InterfaceMaterial{});
  scene.shapes.push_back(Shape(OneTriangle()));
  scene.shapes.back().material = 1;
  scene.shapes.back().emission = AreaEmission{Rgb::Gray(1)};
  const auto geometry = MustBuild(scene);
  EXPECT_FALSE(geometry->Occluded({{0.25f, 0.25f, 5}, {0, 0, -1}}));
  EXPECT_TRUE(geometry->emitters().empty());
}

TEST(Conventions, AnEmptySceneHasNoHits) {
  const auto geometry = MustBuild(EmptyScene());
  Hit hit;
  EXPECT_FALSE(geometry->Intersect({{0, 0, 5}, {0, 0, -1}}, &hit));
  EXPECT_FALSE(geometry->Occluded({{0, 0, 5}, {0, 0, -1}}));
}

TEST(Conventions, BoundsHoldEverything) {
  SceneDescription scene = EmptyScene();
  scene.shapes.push_back(Shape(OneTriangle(), Transform::Translate(10, 0, 0)));
  scene.shapes.push_back(Shape(SphereShape{}, Transform::Translate(0, -5, 0)));
  scene.objects.push_back(ObjectOf({Shape(OneTriangle())}));
  scene.instances.push_back(InstanceOf(0, Transform::Translate(0, 0, 20)));
  scene.instances.push_back(InstanceOf(0, Transform::Translate(0, 0, -20)));
  const Geometry::Bounds bounds = MustBuild(scene)->bounds();
  EXPECT_NEAR(bounds.min.x, -1, 1e-6);
  EXPECT_NEAR(bounds.max.x, 11, 1e-6);
  EXPECT_NEAR(bounds.min.y, -6, 1e-6);
  EXPECT_NEAR(bounds.max.y, 1, 1e-6);
  EXPECT_NEAR(bounds.min.z, -20, 1e-6);
  EXPECT_NEAR(bounds.max.z, 20, 1e-6);
}

void ExpectError(const ShapeDescription& shape, const std::string& text) {
  SceneDescription scene = EmptyScene();
  scene.shapes.push_back(shape);
  const auto geometry = Geometry::Build(scene);
  ASSERT_FALSE(geometry.ok()) << text;
  EXPECT_EQ(geometry.status().code(), absl::StatusCode::kInvalidArgument);
  const std::string message(geometry.status().message());
  EXPECT_EQ(message.rfind("scene.pbrt:7: ", 0), 0u) << message;
  EXPECT_NE(message.find(text), std::string::npos) << message;
}

TEST(Conventions, BadShapesAreLocatedErrors) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  TriangleMeshShape mesh = OneTriangle();
  mesh.triangles = {{0, 1, 3}};
  ExpectError(Shape(mesh), "vertex 3");
  mesh = OneTriangle();
  mesh.positions[1].y = nan;
  ExpectError(Shape(mesh), "vertex 1");
  mesh = OneTriangle();
  mesh.normals.resize(2);
  ExpectError(Shape(mesh), "2 normals");
  mesh = OneTriangle();
  mesh.uvs.resize(4);
  ExpectError(Shape(mesh), "4 uvs");
  ExpectError(Shape(OneTriangle(), Transform::Scale(1, 0, 1)), "singular");
  ExpectError(Shape(SphereShape{}, Transform::Scale(1, 0, 1)), "singular");
  ExpectError(Shape(SphereShape{0, 0, 0, 360}), "radius");
  ExpectError(Shape(DiskShape{nan, 1, 0, 360}), "not finite");
  ExpectError(Shape(CylinderShape{-1, 0, 1, 360}), "radius");
  ShapeDescription shape = Shape(OneTriangle());
  shape.material = 5;
  ExpectError(shape, "no material");

  SceneDescription scene = EmptyScene();
  scene.instances.push_back(InstanceOf(0, {}));
  EXPECT_EQ(Geometry::Build(scene).status().message(),
            "scene.pbrt:12: the instance names no object");
}

}  // namespace
}  // namespace strata::testing
