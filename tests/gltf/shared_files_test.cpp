#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/gltf/gltf_file.h"
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

TEST(GltfSharedFiles, Load) {
  if (!std::filesystem::is_directory(SharedFiles())) GTEST_SKIP() << SharedFiles() << " is missing";
  const struct {
    std::filesystem::path folder;
    std::string name;
    size_t files;
    uint64_t triangles;
  } cases[] = {{SharedFiles(), "DamagedHelmet.glb", 1, 15452},
               {SharedFiles() / "Suzanne", "Suzanne.gltf", 4, 3936}};
  for (const auto& c : cases) {
    const DirectorySource source(c.folder);
    const auto file = ReadSceneFile(source, c.name);
    ASSERT_TRUE(file.ok()) << file.status();
    EXPECT_EQ(file->files.size(), c.files) << c.name;
    const auto scene = LoadScene(source, c.name);
    ASSERT_TRUE(scene.ok()) << scene.status();
    EXPECT_EQ((*scene)->geometry().triangle_count(), c.triangles) << c.name;
  }
}

}  // namespace
}  // namespace strata
