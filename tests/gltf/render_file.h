#pragma once

#include <memory>

#include "tests/gltf/gltf_file.h"
#include "tests/transport/test_scene.h"
#include "worker/scene/scene.h"

// Files rendered as they are, for what is seen of them.

namespace strata {

/// "scene.gltf" of the folder, as a worker would load it; fails the test where it cannot be.
inline std::shared_ptr<const Scene> LoadFile(const GltfFolder& folder,
                                             const SceneOptions& options = {}) {
  auto scene = LoadScene(DirectorySource(folder.root()), "scene.gltf", {}, options);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *scene : BuildScene(TestScene());
}

/// A camera 10 above the plane z = 0 that sees of it a rectangle around `x`, `y`, of `width` and
/// `height`, by parallel rays.
inline void AddOrthographicCamera(GltfFile& file, double x, double y, double width, double height) {
  const int camera = file.Append(
      "cameras", {{"type", "orthographic"},
                  {"orthographic",
                   {{"xmag", width / 2}, {"ymag", height / 2}, {"znear", 0.1}, {"zfar", 100}}}});
  file.AddNode({{"camera", camera}, {"translation", {x, y, 10}}});
}

/// A white diffuse surface, of radiance E / pi for an irradiance E: it has no Fresnel reflection,
/// its index is 1.
inline Json WhiteDiffuse() {
  return {
      {"pbrMetallicRoughness", {{"metallicFactor", 0}}},
      {"extensions",
       {{"KHR_materials_ior", {{"ior", 1}}}, {"KHR_materials_specular", {{"specularFactor", 0}}}}}};
}

/// A surface that emits `color` and reflects nothing.
inline Json Unlit(std::array<double, 4> color) {
  return {{"pbrMetallicRoughness", {{"baseColorFactor", color}}},
          {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
}

}  // namespace strata
