#pragma once

#include <filesystem>
#include <string>

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

/// Files under one directory of this machine. Symbolic links that lead out of it are refused.
class DirectorySource : public FileSource {
 public:
  explicit DirectorySource(std::filesystem::path root) : root_(std::move(root)) {}
  absl::StatusOr<std::filesystem::path> Locate(const std::string& bundle_path) const override;

 private:
  std::filesystem::path root_;
};

}  // namespace strata
