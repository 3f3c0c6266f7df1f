#pragma once

#include <filesystem>
#include <memory>

#include "common/status.h"

namespace strata {

/// Keeps other coordinators out of a state directory, whose films and uploads they would remove.
/// Ends with this object or the process.
class DirectoryLock {
 public:
  /// Makes the directory. FAILED_PRECONDITION when another holds it, UNAVAILABLE when it cannot be
  /// written to. File systems that know no locks are trusted.
  static absl::StatusOr<std::unique_ptr<DirectoryLock>> Take(
      const std::filesystem::path& directory);
  ~DirectoryLock();
  DirectoryLock(const DirectoryLock&) = delete;
  DirectoryLock& operator=(const DirectoryLock&) = delete;

 private:
  explicit DirectoryLock(int descriptor) : descriptor_(descriptor) {}
  const int descriptor_;
};

}  // namespace strata
