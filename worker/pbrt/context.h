#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "common/status.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"
#include "worker/scene/warning_list.h"

namespace strata {

/// What all parts of the pbrt reader share while one scene is read.
class ReadContext {
 public:
  /// `scene_path` is the bundle path of the main file; other files are named relative to its
  /// folder.
  ReadContext(const FileSource& source, const std::string& scene_path);

  /// The bundle path of a file the scene names. The file becomes one the scene needs. Errors are
  /// located at `where` and say whether it is missing or outside the root.
  absl::StatusOr<std::string> AddFile(std::string_view name, const SourceLocation& where);
  /// The same for a file that becomes one the scene needs, if ever, by AddNamedFile.
  absl::StatusOr<std::string> NameFile(std::string_view name, const SourceLocation& where) const;
  /// `bundle_path` is of NameFile.
  absl::Status AddNamedFile(const std::string& bundle_path, const SourceLocation& where);
  /// A local path of a file that AddFile has named.
  absl::StatusOr<std::filesystem::path> Locate(const std::string& bundle_path,
                                               const SourceLocation& where) const;
  /// All of a text file that AddFile has named; at most 4 GiB.
  absl::StatusOr<std::string> ReadText(const std::string& bundle_path,
                                       const SourceLocation& where) const;

  void Warn(const SourceLocation& where, std::string_view text) { warnings.Add(where, text); }

  SceneDescription scene;
  WarningList warnings;
  std::set<std::string> files;  ///< Bundle paths.

 private:
  const FileSource& source_;
  const std::string directory_;
};

}  // namespace strata
