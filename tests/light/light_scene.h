#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "worker/light/light_set.h"

namespace strata {

/// A folder of images and IES files that is removed at the end of a test.
class LightFiles {
 public:
  LightFiles() {
    std::string name = ::testing::TempDir() + "/strata_light_XXXXXX";
    folder_ = mkdtemp(name.data());
  }
  ~LightFiles() { std::filesystem::remove_all(folder_); }
  LightFiles(const LightFiles&) = delete;
  LightFiles& operator=(const LightFiles&) = delete;

  void Write(const std::string& name, const std::string& bytes) const {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  /// A float image, row 0 at the top.
  void WriteImage(const std::string& name, int width, int height,
                  const std::vector<Rgb>& pixels) const {
    std::string bytes = "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
    for (int row = height - 1; row >= 0; --row) {
      bytes.append(reinterpret_cast<const char*>(&pixels[static_cast<size_t>(row) * width]),
                   static_cast<size_t>(width) * sizeof(Rgb));
    }
    Write(name, bytes);
  }
  DirectorySource source() const { return DirectorySource(folder_); }

 private:
  std::filesystem::path folder_;
};

/// The lights of a description and what they refer to.
struct LightScene {
  explicit LightScene(SceneDescription scene, const FileSource& source = DirectorySource("."),
                      const BuildOptions& options = {}) {
    scene.textures.push_back(ConstantTexture{Rgb::Gray(0.5f)});
    scene.materials.push_back(DiffuseMaterial{static_cast<TextureId>(scene.textures.size()) - 1});
    auto built = Geometry::Build(scene);
    EXPECT_TRUE(built.ok()) << built.status();
    geometry = *std::move(built);
    textures = *TextureSet::Load(scene.textures, source);
    auto set = LightSet::Build(scene, *geometry, *textures, source, options);
    EXPECT_TRUE(set.ok()) << set.status();
    if (set.ok()) lights = *std::move(set);
  }

  std::unique_ptr<Geometry> geometry;
  std::unique_ptr<TextureSet> textures;
  LightSet lights;
};

}  // namespace strata
