#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "tests/gltf/gltf_file.h"
#include "tests/transport/kernels.h"
#include "worker/integrator/render.h"
#include "worker/scene/scene.h"

// Files that are not ours: they load as a worker would load them.

namespace strata {
namespace {

std::filesystem::path SharedFiles() {
  const char* shared = std::getenv("STRATA_SHARED");
  return (shared ? std::filesystem::path(shared)
                 : std::filesystem::path(STRATA_SOURCE_DIR "/../shared")) /
         "scenes" / "gltf";
}

struct SharedFile {
  std::filesystem::path folder;
  std::string name;
  size_t files;
  uint64_t triangles;
  double covered;  ///< Of a square frame by the default camera, as it was once seen.
};

std::vector<SharedFile> Files() {
  return {{SharedFiles(), "DamagedHelmet.glb", 1, 15452, 0.22},
          {SharedFiles() / "Suzanne", "Suzanne.gltf", 4, 3936, 0.18}};
}

TEST(GltfSharedFiles, Load) {
  if (!std::filesystem::is_directory(SharedFiles())) GTEST_SKIP() << SharedFiles() << " is missing";
  for (const SharedFile& c : Files()) {
    const DirectorySource source(c.folder);
    const auto file = ReadSceneFile(source, c.name);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->files.size(), c.files) << c.name;
    const auto scene = LoadScene(source, c.name);
    ASSERT_TRUE(scene.ok()) << scene.status();
    EXPECT_EQ((*scene)->geometry().triangle_count(), c.triangles) << c.name;
  }
}

/// Neither has a light: the environment is white. They fill what they should of the frame, and show
/// colours.
TEST(GltfSharedFiles, RenderAlikeByBothKernels) {
  if (!std::filesystem::is_directory(SharedFiles())) GTEST_SKIP() << SharedFiles() << " is missing";
  for (const SharedFile& c : Files()) {
    SCOPED_TRACE(c.name);
    const auto scene = LoadScene(DirectorySource(c.folder), c.name);
    ASSERT_TRUE(scene.ok()) << scene.status();
    JobSpec spec = TestSpec(64, 64, 5);
    spec.channels = {.alpha = true, .albedo = true, .normal = true, .depth = true};
    EXPECT_GE(AgreeingShare(*scene, spec, 1e-5), 0.999);
    const Partial partial = RenderFrame(*scene, spec);
    double covered = 0, coloured = 0;
    for (int64_t i = 0; i < partial.pixels.Pixels(); ++i) {
      const double alpha = partial.values[i * partial.layout.Doubles() + partial.layout.Plain(0)];
      covered += alpha;
      if (alpha < 0.99) continue;
      const double red = PixelMean(partial, i, 0), blue = PixelMean(partial, i, 2);
      EXPECT_LE(red, 1.6) << i;
      coloured += std::abs(red - blue) > 0.05 * (red + blue);
    }
    const double pixels = static_cast<double>(partial.pixels.Pixels());
    EXPECT_NEAR(covered / pixels, c.covered, 0.02);
    EXPECT_GT(coloured, 0.2 * covered);
  }
}

}  // namespace
}  // namespace strata
