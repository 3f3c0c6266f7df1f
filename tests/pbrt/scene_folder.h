#pragma once

#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "worker/pbrt/reader.h"

namespace strata {

/// A folder of scene files that is removed at the end of a test.
class SceneFolder {
 public:
  SceneFolder() {
    static std::atomic<int> next{0};
    root_ = std::filesystem::temp_directory_path() /
            ("strata-pbrt-" + std::to_string(getpid()) + "-" + std::to_string(next++));
    std::filesystem::create_directories(root_);
  }
  ~SceneFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(root_, ignored);
  }
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  void Write(const std::string& path, std::string_view text) const {
    std::filesystem::create_directories((root_ / path).parent_path());
    std::ofstream(root_ / path, std::ios::binary) << text;
  }
  absl::StatusOr<PbrtScene> Read(const std::string& path = "scene.pbrt") const {
    return ReadPbrt(DirectorySource(root_), path);
  }
  const std::filesystem::path& root() const { return root_; }

 private:
  std::filesystem::path root_;
};

/// The scene of a single file.
inline absl::StatusOr<PbrtScene> ReadText(std::string_view text) {
  SceneFolder folder;
  folder.Write("scene.pbrt", text);
  return folder.Read();
}

/// The scene of a single file whose world is `world`; line 1 holds WorldBegin.
inline absl::StatusOr<PbrtScene> ReadWorld(std::string_view world) {
  return ReadText("WorldBegin\n" + std::string(world));
}

/// Where the scenes that are not ours lie; empty when they are missing.
inline std::filesystem::path SharedScenes() {
  const char* shared = std::getenv("STRATA_SHARED");
  const std::filesystem::path folder =
      (shared ? std::filesystem::path(shared)
              : std::filesystem::path(STRATA_SOURCE_DIR "/../shared")) /
      "scenes" / "pbrt";
  return std::filesystem::is_directory(folder) ? folder : std::filesystem::path();
}

}  // namespace strata
