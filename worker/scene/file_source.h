#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <utility>

#include "common/status.h"

namespace strata {

/// Where the files of a scene are found by the path they have in its bundle.
class FileSource {
 public:
  virtual ~FileSource() = default;
  /// A readable local file with the content of `bundle_path` and the same extension. NOT_FOUND when
  /// there is none; INVALID_ARGUMENT when the path leads outside the root.
  virtual absl::StatusOr<std::filesystem::path> Locate(const std::string& bundle_path) const = 0;
};

/// Local files by bundle path.
using FilesElsewhere = std::map<std::string, std::filesystem::path>;

/// Files under one directory of this machine. Symbolic links that lead out of it are refused.
class DirectorySource : public FileSource {
 public:
  /// `elsewhere`: files that a user, and not the scene, has named, wherever they lie.
  explicit DirectorySource(std::filesystem::path root, FilesElsewhere elsewhere = {})
      : root_(std::move(root)), elsewhere_(std::move(elsewhere)) {}
  absl::StatusOr<std::filesystem::path> Locate(const std::string& bundle_path) const override;

 private:
  std::filesystem::path root_;
  FilesElsewhere elsewhere_;
};

/// All bytes of a file of at most `limit` bytes; of a gzip file, what it holds.
absl::StatusOr<std::string> ReadWholeFile(const std::filesystem::path& path, uint64_t limit);

}  // namespace strata
