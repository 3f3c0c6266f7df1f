#pragma once

#include <filesystem>

#include "common/status.h"

namespace strata {

/// A new directory under the system's place for temporary files, removed with all it holds at the
/// end of its life.
class TemporaryDirectory {
 public:
  static absl::StatusOr<TemporaryDirectory> Create();
  ~TemporaryDirectory();
  TemporaryDirectory(TemporaryDirectory&& other) noexcept;
  TemporaryDirectory& operator=(TemporaryDirectory&& other) noexcept;

  const std::filesystem::path& path() const { return path_; }

 private:
  explicit TemporaryDirectory(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;  ///< Empty when moved from.
};

}  // namespace strata
