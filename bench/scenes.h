#pragma once

#include <absl/strings/numbers.h>
#include <absl/strings/strip.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include "worker/integrator/render.h"
#include "worker/scene/scene.h"

// Scenes that benches make themselves, beside those of files.

namespace strata {

/// The same numbers anywhere.
class Uniform {
 public:
  float operator()(float low, float high) {
    return low + (high - low) * static_cast<float>(random_() >> 8) * 0x1p-24f;
  }

 private:
  std::mt19937 random_{1};
};

inline SceneDescription GrayScene() {
  SceneDescription scene;
  scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
  scene.materials.push_back(DiffuseMaterial{0});
  return scene;
}

inline void AddBox(SceneDescription* scene, Vec3f low, Vec3f high) {
  TriangleMeshShape box;
  for (int i = 0; i < 8; ++i)
    box.positions.push_back(
        {i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  box.triangles = {{0, 1, 3}, {0, 3, 2}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                   {2, 3, 7}, {2, 7, 6}, {0, 2, 6}, {0, 6, 4}, {1, 3, 7}, {1, 7, 5}};
  scene->shapes.emplace_back().geometry = box;
}

/// A closed room with `boxes` on its floor and in the air, lit by a lamp of two triangles: 12 for
/// the room and each box. More than 24 of them are as much smaller as leaves the room as full.
inline SceneDescription RoomOfBoxes(int boxes) {
  Uniform uniform;
  SceneDescription scene = GrayScene();
  AddBox(&scene, {-1, -1, -1}, {1, 1, 1});
  const float scale = boxes > 24 ? std::cbrt(24.0f / static_cast<float>(boxes)) : 1;
  for (int i = 0; i < boxes; ++i) {
    const Vec3f size = Vec3f{uniform(0.1f, 0.4f), uniform(0.1f, 0.4f), uniform(0.1f, 0.4f)} * scale;
    const Vec3f at = {uniform(-0.9f, 0.5f), uniform(-0.4f, 0.5f), uniform(-1, 0.3f)};
    AddBox(&scene, at, at + size);
  }
  TriangleMeshShape lamp;
  lamp.positions = {
      {-0.3f, -0.3f, 0.99f}, {-0.3f, 0.3f, 0.99f}, {0.3f, 0.3f, 0.99f}, {0.3f, -0.3f, 0.99f}};
  lamp.triangles = {{0, 1, 2}, {0, 2, 3}};
  ShapeDescription& shape = scene.shapes.emplace_back();
  shape.geometry = lamp;
  shape.emission = AreaEmission{Rgb::Gray(10)};
  scene.camera.camera_to_world =
      *Transform::LookAt({0, -0.95, 0}, {0, 0, -0.2}, {0, 0, 1})->Inverse();
  scene.camera.fov = 70;
  scene.defaults.max_depth = 12;
  return scene;
}

/// A hall of 200 x 200 x 5 metres, with shelves, under 10,000 small lamps of many strengths that
/// shine down and a little aside. The camera looks at the floor: lamps in view are noise that no
/// way of choosing among them removes.
inline SceneDescription ManyLights() {
  Uniform uniform;
  SceneDescription scene = GrayScene();
  AddBox(&scene, {-100, -100, 0}, {100, 100, 5});
  for (int i = 0; i < 2000; ++i) {
    const Vec3f at = {uniform(-99, 99), uniform(-99, 99), 0};
    AddBox(&scene, at, at + Vec3f{uniform(0.2f, 2), uniform(0.2f, 2), uniform(0.2f, 3)});
  }
  for (int i = 0; i < 10000; ++i) {
    TriangleMeshShape lamp;
    lamp.positions = {{-0.05f, -0.05f, 0}, {0, 0.05f, 0}, {0.05f, -0.05f, 0}};
    lamp.triangles = {{0, 1, 2}};
    ShapeDescription shape;
    shape.geometry = lamp;
    const float x = uniform(-99, 99), y = uniform(-99, 99), z = uniform(4, 4.9f);
    const float degrees = uniform(-40, 40), across = uniform(-1, 1), along = uniform(-1, 1);
    shape.to_world = Transform::Translate(x, y, z) * Transform::Rotate(degrees, across, along, 0);
    const float strength = uniform(0, 1);
    shape.emission = AreaEmission{Rgb{uniform(0.5f, 1), uniform(0.5f, 1), uniform(0.5f, 1)} *
                                  (2000 * strength * strength)};
    scene.shapes.push_back(std::move(shape));
  }
  scene.camera.camera_to_world =
      *Transform::LookAt({-9, -8, 3.9}, {-3, -3, 0}, {0, 0, 1})->Inverse();
  scene.camera.fov = 60;
  return scene;
}

/// What the command line says of them.
inline constexpr char kBenchScenes[] =
    "pbrt files, \"many-lights\": 10,000 of them, or \"room-N\": with N boxes";

inline absl::StatusOr<std::shared_ptr<const Scene>> LoadBenchScene(const std::string& path,
                                                                   const BuildOptions& build = {}) {
  int boxes = 0;
  if (absl::SimpleAtoi(absl::StripPrefix(path, "room-"), &boxes) && path.starts_with("room-"))
    return Scene::Build(RoomOfBoxes(boxes), DirectorySource("."), build);
  if (path == "many-lights") return Scene::Build(ManyLights(), DirectorySource("."), build);
  const std::filesystem::path file = std::filesystem::absolute(path);
  return LoadScene(DirectorySource(file.parent_path()), file.filename().string(), build);
}

}  // namespace strata
