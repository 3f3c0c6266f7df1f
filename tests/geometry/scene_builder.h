#pragma once

#include <memory>
#include <random>
#include <utility>

#include <gtest/gtest.h>

#include "worker/geometry/geometry.h"
#include "worker/math/vec3d.h"

// Small scenes and random placements for the tests of this folder.

namespace strata::testing {

using Random = std::mt19937_64;

inline double Uniform(Random& random, double low = 0, double high = 1) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

inline Vec3d UnitVector(Random& random) {
  for (;;) {
    const Vec3d v = {Uniform(random, -1, 1), Uniform(random, -1, 1), Uniform(random, -1, 1)};
    const double length2 = Dot(v, v);
    if (length2 > 1e-4 && length2 <= 1) return Normalize(v);
  }
}

inline Transform RandomRotation(Random& random) {
  const Vec3d axis = UnitVector(random);
  return Transform::Rotate(Uniform(random, 0, 360), axis.x, axis.y, axis.z);
}

inline Transform RandomSimilarity(Random& random, double scale = 1) {
  return Transform::Translate(scale * Uniform(random, -3, 3), scale * Uniform(random, -3, 3),
                              scale * Uniform(random, -3, 3)) *
         RandomRotation(random) * Transform::Scale(scale, scale, scale);
}

/// Rotates, stretches, shears and sometimes mirrors.
inline Transform RandomAffine(Random& random, double scale = 1) {
  const auto stretch = [&] { return scale * Uniform(random, 0.5, 2); };
  const double mirror = random() & 1 ? -1 : 1;
  return Transform::Translate(scale * Uniform(random, -3, 3), scale * Uniform(random, -3, 3),
                              scale * Uniform(random, -3, 3)) *
         RandomRotation(random) * Transform::Scale(stretch(), stretch(), mirror * stretch()) *
         RandomRotation(random);
}

inline SceneDescription EmptyScene() {
  SceneDescription scene;
  scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
  scene.materials.push_back(DiffuseMaterial{0});
  return scene;
}

inline ShapeDescription Shape(ShapeGeometry geometry, const Transform& to_world = {}) {
  ShapeDescription shape;
  shape.where = {"scene.pbrt", 7};
  shape.geometry = std::move(geometry);
  shape.to_world = to_world;
  return shape;
}

inline InstanceDescription InstanceOf(int32_t object, const Transform& to_world) {
  InstanceDescription instance;
  instance.where.file = "scene.pbrt";
  instance.where.line = 12;
  instance.object = object;
  instance.to_world = to_world;
  return instance;
}

inline ObjectDescription ObjectOf(std::vector<ShapeDescription> shapes) {
  ObjectDescription object;
  object.name = "object";
  object.shapes = std::move(shapes);
  return object;
}

inline std::unique_ptr<Geometry> MustBuild(const SceneDescription& scene) {
  absl::StatusOr<std::unique_ptr<Geometry>> geometry = Geometry::Build(scene);
  EXPECT_TRUE(geometry.ok()) << geometry.status();
  return geometry.ok() ? std::move(*geometry) : nullptr;
}

inline std::unique_ptr<Geometry> MustBuild(ShapeDescription shape) {
  SceneDescription scene = EmptyScene();
  scene.shapes.push_back(std::move(shape));
  return MustBuild(scene);
}

/// The unit sphere as a closed mesh with about 2 n^2 triangles, outer sides outwards.
inline TriangleMeshShape SphereMesh(int n) {
  TriangleMeshShape mesh;
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      const double theta = M_PI * i / n, phi = M_PI * j / n;
      mesh.positions.push_back(ToFloat(
          {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)}));
    }
  }
  const auto vertex = [&](int i, int j) {
    // One vertex at each pole, so that the mesh is closed.
    return static_cast<uint32_t>(i == 0 ? 0 : i == n ? n * 2 * n : i * 2 * n + j % (2 * n));
  };
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * n; ++j) {
      if (i > 0) mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i, j + 1)});
      if (i < n - 1)
        mesh.triangles.push_back({vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

/// The cube [-1, 1]^3, outer sides outwards.
inline TriangleMeshShape CubeMesh() {
  TriangleMeshShape mesh;
  for (int corner = 0; corner < 8; ++corner)
    mesh.positions.push_back(
        {corner & 1 ? 1.0f : -1.0f, corner & 2 ? 1.0f : -1.0f, corner & 4 ? 1.0f : -1.0f});
  mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                    {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  return mesh;
}

inline Ray MakeRay(Vec3d origin, Vec3d direction) { return {ToFloat(origin), ToFloat(direction)}; }

}  // namespace strata::testing
