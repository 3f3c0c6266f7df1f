#include "tests/light/lamp.h"

#include <gtest/gtest.h>

#include <utility>

namespace strata {

Lamp::Lamp(ShapeDescription shape) {
  SceneDescription scene;
  scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
  scene.shapes.push_back(std::move(shape));
  Build(std::move(scene), DirectorySource("."));
}

Lamp::Lamp(ShapeDescription shape, const TextureDescription& texture, const FileSource& source) {
  SceneDescription scene;
  scene.textures = {ConstantTexture{Rgb::Gray(0.5f)}, texture};
  shape.emission->texture = 1;
  scene.shapes.push_back(std::move(shape));
  Build(std::move(scene), source);
}

void Lamp::Build(SceneDescription scene, const FileSource& source) {
  scene.materials.push_back(DiffuseMaterial{0});
  auto geometry = Geometry::Build(scene);
  EXPECT_TRUE(geometry.ok()) << geometry.status();
  geometry_ = *std::move(geometry);
  textures_ = *TextureSet::Load(scene.textures, source);
  auto lights = LightSet::Build(scene, *geometry_, *textures_, source);
  EXPECT_TRUE(lights.ok()) << lights.status();
  lights_ = *std::move(lights);
  EXPECT_EQ(lights_.lights().size(), 1u);
}

std::vector<Lamp::Meeting> Lamp::Meetings(Vec3f from, Vec3f direction) const {
  std::vector<Meeting> meetings;
  Ray ray = {from, direction};
  for (Hit found; geometry_->Intersect(ray, &found);) {
    const SurfacePoint point = geometry_->Surface(ray, found);
    const EmissionHit hit = {point.p, point.ng, direction, Length(point.p - from)};
    const Rgb radiance = lights_.SurfaceLe(0, point.ng, -direction, [&] { return point; });
    if (!IsBlack(radiance)) {
      meetings.push_back({hit, radiance, lights_.SurfacePdf(0, {from}, hit)});
      if (IsSphere()) break;
    }
    ray.origin = OffsetRayOrigin(point, direction);
  }
  return meetings;
}

bool Lamp::IsSphere() const {
  const Light& light = lights_.lights()[0];
  const auto* textured = std::get_if<TexturedLight>(&light);
  return textured ? std::holds_alternative<SphereLight>(textured->surface->plain)
                  : std::holds_alternative<SphereLight>(light);
}

float Lamp::Pdf(Vec3f from, Vec3f direction) const {
  float sum = 0;
  for (const Meeting& meeting : Meetings(from, direction)) sum += meeting.pdf;
  return sum;
}

ShapeDescription EmissiveShape(ShapeGeometry geometry, const Transform& to_world, bool two_sided) {
  ShapeDescription shape;
  shape.geometry = std::move(geometry);
  shape.to_world = to_world;
  shape.emission = AreaEmission{{1, 0.5f, 0.25f}, two_sided};
  return shape;
}

std::vector<LampCase> AllLampCases() {
  TriangleMeshShape mesh;
  mesh.positions = {{-1, -0.5f, 0}, {1, -0.5f, 0}, {0.4f, 1.1f, 0}};
  mesh.triangles = {{0, 1, 2}};
  const ShapeDescription triangle = EmissiveShape(mesh);
  mesh.positions[2] = {0.2f, -0.4f, 0};
  const ShapeDescription sliver = EmissiveShape(mesh);

  mesh.positions = {{-1, -0.5f, 0}, {1, -0.5f, 0}, {1, 0.5f, 0}, {-1, 0.5f, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  const ShapeDescription rectangle = EmissiveShape(mesh, Transform::Rotate(30, 1, 2, 3));
  mesh.positions[3].z = 2e-6f;
  const ShapeDescription uneven = EmissiveShape(mesh);
  mesh.positions[3].z = 0;
  mesh.positions[2].x = 1.5f;
  mesh.positions[3].x = -0.5f;
  const ShapeDescription parallelogram = EmissiveShape(mesh);

  const Transform place = Transform::Translate(1, 2, 3);
  const ShapeDescription bulb = EmissiveShape(SphereShape{0.5f, -0.5f, 0.5f, 360}, place);
  ShapeDescription sphere = bulb, hollow = bulb;
  sphere.emission->two_sided = hollow.emission->two_sided = false;
  hollow.reverse_orientation = true;

  const ShapeDescription disk = EmissiveShape(DiskShape{.radius = 1});
  const ShapeDescription arc =
      EmissiveShape(DiskShape{0.2f, 1, 0.5f, 270}, Transform::Scale(1, 2, 1));
  const ShapeDescription cylinder = EmissiveShape(CylinderShape{0.5f, -1, 1, 360});
  const ShapeDescription shield = EmissiveShape(CylinderShape{0.5f, -1, 1, 100});
  const ShapeDescription gutter =
      EmissiveShape(CylinderShape{0.5f, -1, 1, 200}, Transform::Scale(2, 1, 1));
  const ShapeDescription egg =
      EmissiveShape(SphereShape{0.5f, -0.5f, 0.5f, 360}, Transform::Scale(1, 1, 2));
  const ShapeDescription bowl = EmissiveShape(SphereShape{0.5f, -0.4f, 0.3f, 250});
  const ShapeDescription cap = EmissiveShape(SphereShape{0.5f, 0.3f, 0.5f, 300}, place);
  BilinearPatchShape bilinear;
  bilinear.positions = {
      {-1, -1, 0.3f}, {1.2f, -0.8f, -0.5f}, {-0.5f, 1, -0.2f}, {0.7f, 0.6f, 0.9f}};
  bilinear.patches = {{0, 1, 2, 3}};
  const ShapeDescription patch = EmissiveShape(bilinear);

  return {
      {"triangle", triangle, {0.3f, -0.6f, 1.5f}},
      {"triangle, near", triangle, {0.1f, 0, 0.1f}},
      {"triangle, near and grazing", triangle, {0.5f, 0.2f, 0.01f}},
      {"triangle, near and from its side", triangle, {0.9f, 0.6f, 0.05f}},
      {"triangle, far", triangle, {20, 30, 40}},
      {"triangle, grazing", triangle, {0.4f, -3, 0.1f}},
      {"sliver", sliver, {0, -0.6f, 0.5f}},
      {"sliver, near", sliver, {0.1f, -0.45f, 0.03f}},
      {"rectangle", rectangle, {0.3f, -0.6f, 1.5f}},
      {"rectangle, near", rectangle, {0.1f, 0.2f, 0.4f}},
      {"rectangle, very near", rectangle, {0.01f, 0.02f, 0.03f}},
      {"rectangle, far", rectangle, {20, 30, 40}},
      {"rectangle, grazing", rectangle, {1.1f, 0.35f, -0.4f}},
      {"rectangle, uneven", uneven, {-0.7f, 0.3f, 0.01f}},
      {"parallelogram", parallelogram, {0.3f, -0.6f, 1.5f}},
      {"parallelogram, near", parallelogram, {0.1f, 0.2f, 0.4f}},
      {"sphere", sphere, {1, 2, 1.5f}},
      {"sphere, near", sphere, {1, 2, 2.495f}},
      {"sphere, far", sphere, {30, -40, 60}},
      {"sphere of two sides", bulb, {2, 2, 3.2f}},
      {"sphere, within", hollow, {1.1f, 2.2f, 3.1f}},
      {"sphere of two sides, within", bulb, {1, 1.6f, 3}},
      {"disk", disk, {0.8f, 0.5f, 1}},
      {"disk, near", disk, {0.3f, 0.2f, -0.1f}},
      {"disk, far", disk, {50, 30, 20}},
      {"arc of a stretched disk", arc, {0.4f, 0.3f, 1.2f}},
      {"cylinder, within", cylinder, {0.1f, -0.2f, 0.7f}},
      {"part of a cylinder", shield, {1, 1.2f, 0.6f}},
      {"part of a stretched cylinder", gutter, {0.3f, 0.1f, 0.2f}},
      {"spheroid, within", egg, {0.1f, -0.2f, 0.3f}},
      {"part of a sphere, within", bowl, {0.1f, -0.05f, 0.1f}},
      {"part of a sphere", cap, {1.1f, 2.2f, 5}},
      {"patch", patch, {0.5f, 0.4f, 2}},
      {"patch, near", patch, {0.1f, 0.1f, 1}},
  };
}

}  // namespace strata
