#pragma once

#include <filesystem>
#include <string>

#include "cli/temporary_directory.h"

namespace strata::test {

/// A directory for one test, with small scenes in it; removed at the end.
class SceneFolder {
 public:
  SceneFolder();

  /// The absolute path of `name` in the folder.
  std::string Path(const std::string& name) const { return (directory_.path() / name).string(); }
  /// Writes a file and returns its path.
  std::string Write(const std::string& name, const std::string& content) const;
  /// A lit box of 24x16 pixels, 16 samples each, of nothing but supported things.
  std::string TinyScene() const;
  /// The same with so many samples that it renders for minutes.
  std::string LongScene() const;

 private:
  TemporaryDirectory directory_;
};

/// A whole file.
std::string ReadFile(const std::filesystem::path& path);

}  // namespace strata::test
