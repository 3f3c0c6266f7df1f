#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>

#include "tests/stability/picture.h"

// No sample of a real scene is NaN or infinite. A short run; docs/stability.md has the long one.

namespace strata {
namespace {

/// Renders the scene `file` of the folder; the paths that were traced.
uint64_t ExpectFinite(const std::filesystem::path& folder, const std::string& file) {
  SCOPED_TRACE((folder / file).string());
  const auto scene = LoadScene(DirectorySource(folder), file);
  EXPECT_TRUE(scene.ok()) << scene.status();
  if (!scene.ok()) return 0;
  const Picture picture = Render(*scene, {.size = 64, .spp = 64, .max_depth = 20});
  EXPECT_EQ(picture.nonfinite, 0u);
  EXPECT_GT(MeanOf(picture).mean, 0);
  for (const PixelEstimate& pixel : picture.pixels) {
    for (int c = 0; c < kColours; ++c) EXPECT_TRUE(std::isfinite(pixel.ci95[c]));
  }
  return picture.samples;
}

void ReportPaths(uint64_t paths) {
  EXPECT_GT(paths, 0u);
  Report("paths without a value that is not finite", static_cast<double>(paths));
}

TEST(OwnScenes, HaveNoSampleThatIsNotFinite) {
  uint64_t paths = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(STRATA_SOURCE_DIR "/scenes")) {
    const std::filesystem::path& path = entry.path();
    if (path.extension() == ".pbrt")
      paths += ExpectFinite(path.parent_path(), path.filename().string());
  }
  ReportPaths(paths);
}

TEST(SharedScenes, HaveNoSampleThatIsNotFinite) {
  const std::filesystem::path scenes = SharedScenes();
  if (scenes.empty()) GTEST_SKIP() << "the shared scenes are missing; the project's own pass";
  uint64_t paths = 0;
  for (const auto& folder : std::filesystem::directory_iterator(scenes))
    paths += ExpectFinite(folder.path(), "scene.pbrt");
  ReportPaths(paths);
}

}  // namespace
}  // namespace strata
