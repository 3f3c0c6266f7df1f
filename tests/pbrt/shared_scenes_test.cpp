// The scenes that no one here wrote load, with the warnings they deserve and no others.

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "tests/pbrt/scene_folder.h"

namespace strata {
namespace {

struct Expected {
  size_t triangles;
  size_t emitters, lights;
  int width, height, max_depth;
};

// From the scenes' own description (triangles rounded there) and their files.
const std::map<std::string, Expected> kScenes = {
    {"classroom", {103832, 0, 2, 1280, 720, 17}},
    {"coffee", {235271, 3, 0, 800, 1000, 17}},
    {"cornell-box", {36, 1, 0, 1024, 1024, 65}},
    {"staircase2", {30927, 13, 0, 1024, 1024, 65}},
    {"teapot-full", {126744, 0, 1, 1280, 720, 65}},
    {"veach-bidir", {11544, 2, 0, 1024, 1024, 7}},
    {"veach-mis", {52, 3, 0, 1280, 720, 3}},
    {"volumetric-caustic", {14, 1, 0, 1024, 1024, 7}},
};

TEST(SharedScenes, Load) {
  const std::filesystem::path folder = SharedScenes();
  if (folder.empty()) GTEST_SKIP() << "../shared/scenes is missing";
  for (const auto& [name, expected] : kScenes) {
    SCOPED_TRACE(name);
    const absl::StatusOr<PbrtScene> read = ReadPbrt(DirectorySource(folder / name), "scene.pbrt");
    ASSERT_TRUE(read.ok()) << read.status();
    const SceneDescription& scene = read->scene;
    size_t triangles = 0, emitters = 0;
    for (const ShapeDescription& shape : scene.shapes) {
      const auto* mesh = std::get_if<TriangleMeshShape>(&shape.geometry);
      triangles += mesh ? mesh->triangles.size() : 0;
      emitters += shape.emission.has_value();
    }
    EXPECT_EQ(triangles, expected.triangles);
    EXPECT_EQ(emitters, expected.emitters);
    EXPECT_EQ(scene.lights.size(), expected.lights);
    EXPECT_EQ(scene.defaults.width, expected.width);
    EXPECT_EQ(scene.defaults.height, expected.height);
    EXPECT_EQ(scene.defaults.max_depth, expected.max_depth);
    EXPECT_EQ(scene.defaults.spp, 64u);
    for (const SceneWarning& warning : read->warnings) {
      EXPECT_NE(warning.text.find("image filter"), std::string::npos)
          << warning.where.ToString() << ": " << warning.text;
    }
  }
}

TEST(OwnScenes, LoadWithoutWarnings) {
  const std::map<std::string, size_t> scenes = {
      {"cornell-box/cornell-box.pbrt", 0},
      {"furnace/closed-furnace.pbrt", 0},
      {"textures/textures.pbrt", 1}};  // a glass without dispersion
  for (const auto& [path, warnings] : scenes) {
    const absl::StatusOr<PbrtScene> scene =
        ReadPbrt(DirectorySource(std::filesystem::path(STRATA_SOURCE_DIR) / "scenes"), path);
    ASSERT_TRUE(scene.ok()) << scene.status();
    EXPECT_EQ(scene->warnings.size(), warnings) << path;
  }
}

}  // namespace
}  // namespace strata
