#include <gtest/gtest.h>

#include "tests/stability/picture.h"

// No sample of a real scene is NaN or infinite. A short run; docs/stability.md has the long one.

namespace strata {
namespace {

TEST(SharedScenes, HaveNoSampleThatIsNotFinite) {
  const std::filesystem::path scenes = SharedScenes();
  if (scenes.empty()) GTEST_SKIP() << "the shared scenes are missing";
  uint64_t paths = 0;
  for (const auto& folder : std::filesystem::directory_iterator(scenes)) {
    const std::string name = folder.path().filename().string();
    const auto scene = LoadScene(DirectorySource(folder.path()), "scene.pbrt");
    ASSERT_TRUE(scene.ok()) << scene.status();
    const Picture picture = Render(*scene, {.size = 64, .spp = 64, .max_depth = 20});
    EXPECT_EQ(picture.nonfinite, 0u) << name;
    EXPECT_GT(MeanOf(picture).mean, 0) << name;
    for (const PixelEstimate& pixel : picture.pixels) {
      for (int c = 0; c < kColours; ++c) EXPECT_TRUE(std::isfinite(pixel.ci95[c])) << name;
    }
    paths += picture.samples;
  }
  Report("paths without a value that is not finite", static_cast<double>(paths));
}

}  // namespace
}  // namespace strata
