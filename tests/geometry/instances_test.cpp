#include <cmath>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "tests/geometry/scene_builder.h"

namespace strata::testing {
namespace {

std::vector<ShapeDescription> Parts() {
  TriangleMeshShape mesh = SphereMesh(12);
  mesh.normals = mesh.positions;
  for (const Vec3f& p : mesh.positions) mesh.uvs.push_back({p.x, p.y});
  ShapeDescription disk = Shape(DiskShape{0.5f, 1.2f, 0.3f, 300}, Transform::Rotate(20, 1, 0, 0));
  disk.reverse_orientation = true;
  return {Shape(mesh, Transform::Scale(0.5, 0.8, -0.6)), disk,
          Shape(CylinderShape{0.4f, -1, 1, 360}, Transform::Translate(0.5, 0.2, 0))};
}

TEST(Instances, EqualCopiesOfTheirShapes) {
  Random random(1);
  SceneDescription instanced = EmptyScene(), copied = EmptyScene();
  instanced.objects.push_back(ObjectOf(Parts()));
  for (int i = 0; i < 5; ++i) {
    const Transform to_world = RandomAffine(random);
    instanced.instances.push_back(InstanceOf(0, to_world));
    for (ShapeDescription shape : Parts()) {
      shape.to_world = to_world * shape.to_world;
      copied.shapes.push_back(shape);
    }
  }
  const auto a = MustBuild(instanced), b = MustBuild(copied);
  EXPECT_EQ(b->triangle_count(), 5 * a->triangle_count());
  int hits = 0, differ = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vec3d from = UnitVector(random) * Uniform(random, 0, 6);
    const Ray ray = MakeRay(from, UnitVector(random));
    Hit hit_a, hit_b;
    const bool found = a->Intersect(ray, &hit_a);
    EXPECT_EQ(found, a->Occluded(ray));
    if (found != b->Intersect(ray, &hit_b) ||
        (found && std::abs(hit_a.t - hit_b.t) > 1e-4f * (1 + hit_b.t))) {
      ++differ;
      continue;
    }
    if (!found) continue;
    ++hits;
    const SurfacePoint pa = a->Surface(ray, hit_a), pb = b->Surface(ray, hit_b);
    if (Dot(pa.ng, pb.ng) < 0.9999f) {  // Two surfaces that meet in a line.
      ++differ;
      continue;
    }
    EXPECT_LT(Length(pa.p - pb.p), 2e-5f);
    EXPECT_GT(Dot(pa.ns, pb.ns), 0.999f);
    EXPECT_NEAR(pa.uv.x, pb.uv.x, 1e-3);
    EXPECT_NEAR(pa.uv.y, pb.uv.y, 1e-3);
    EXPECT_LT(Length(pa.dpdu - pb.dpdu), 2e-2f * (1 + Length(pb.dpdu)));
  }
  EXPECT_GT(hits, 4000);
  EXPECT_LE(differ, 10);
}

TEST(Instances, ObjectsPlacedOnceOrNeverTakeNoSpaceTwice) {
  SceneDescription scene = EmptyScene();
  scene.objects.push_back(ObjectOf({Shape(CubeMesh())}));
  scene.objects.push_back(ObjectOf({Shape(CubeMesh())}));
  scene.instances.push_back(InstanceOf(1, Transform::Translate(5, 0, 0)));
  const auto geometry = MustBuild(scene);
  EXPECT_EQ(geometry->triangle_count(), 12u);
  EXPECT_FALSE(geometry->Occluded({{0, 0, 5}, {0, 0, -1}}));
  EXPECT_TRUE(geometry->Occluded({{5, 0, 5}, {0, 0, -1}}));
}

TEST(Instances, EmissiveShapesShineFromEveryInstance) {
  SceneDescription scene = EmptyScene();
  ShapeDescription lamp = Shape(SphereShape{});
  lamp.emission = AreaEmission{Rgb::Gray(3)};
  scene.objects.push_back(ObjectOf({lamp, Shape(CubeMesh(), Transform::Translate(0, 3, 0))}));
  for (int i = 0; i < 3; ++i)
    scene.instances.push_back(InstanceOf(0, Transform::Translate(10 * i, 0, 0)));
  const auto geometry = MustBuild(scene);
  ASSERT_EQ(geometry->emitters().size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const Ray ray = {{10.0f * i, 0, 5}, {0, 0, -1}};
    Hit hit;
    ASSERT_TRUE(geometry->Intersect(ray, &hit));
    const int32_t light = geometry->Surface(ray, hit).light;
    ASSERT_GE(light, 0);
    const auto& sphere = std::get<SphereEmitter>(geometry->emitters()[light].shape);
    EXPECT_EQ(sphere.center.x, 10 * i);
  }
}

TEST(Instances, SingularPlacesAreLocatedErrors) {
  SceneDescription scene = EmptyScene();
  scene.objects.push_back(ObjectOf({Shape(CubeMesh())}));
  for (int i = 0; i < 2; ++i) scene.instances.push_back(InstanceOf(0, Transform::Scale(1, 1, 0)));
  const auto geometry = Geometry::Build(scene);
  ASSERT_FALSE(geometry.ok());
  EXPECT_EQ(geometry.status().message().rfind("scene.pbrt:12: ", 0), 0u) << geometry.status();
}

}  // namespace
}  // namespace strata::testing
