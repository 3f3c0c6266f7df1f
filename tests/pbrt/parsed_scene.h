#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tests/pbrt/scene_folder.h"

// Sound files, and what the scenes hold that are made of them.

namespace strata {

/// Fails the test where `text` is refused.
inline PbrtScene Read(const std::string& text) {
  absl::StatusOr<PbrtScene> scene = ReadText(text);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return scene.ok() ? *std::move(scene) : PbrtScene();
}

inline PbrtScene World(const std::string& world) { return Read("WorldBegin\n" + world); }

/// The value of a constant texture.
inline Rgb Constant(const PbrtScene& scene, TextureId id) {
  return std::get<ConstantTexture>(scene.scene.textures.at(id)).value;
}

template <typename T>
T MaterialOf(const PbrtScene& scene, size_t id = 1) {
  return std::get<T>(scene.scene.materials.at(id));
}

template <typename T>
T LightOf(const PbrtScene& scene) {
  return std::get<T>(scene.scene.lights.at(0).light);
}

}  // namespace strata
