#include "worker/scene/file_source.h"

#include <algorithm>
#include <fstream>
#include <system_error>
#include <utility>

#include "common/bundle.h"
#include "common/text.h"
#include "worker/scene/gzip.h"

namespace strata {

absl::StatusOr<std::filesystem::path> DirectorySource::Locate(
    const std::string& bundle_path) const {
  namespace fs = std::filesystem;
  if (const auto found = elsewhere_.find(bundle_path); found != elsewhere_.end())
    return found->second;
  if (!IsBundlePath(bundle_path)) {
    return absl::InvalidArgumentError(StrCat(
        "\"", bundle_path, "\" is no path inside the scene's root; it must be relative to it"));
  }
  std::error_code error;
  const fs::path root = fs::canonical(root_, error);
  if (error) {
    return absl::NotFoundError(
        StrCat("the scene's root \"", root_.string(), "\": ", error.message()));
  }
  const fs::path path = fs::canonical(root / bundle_path, error);
  if (error) {
    return absl::NotFoundError(StrCat("\"", bundle_path, "\": ", error.message()));
  }
  // After symbolic links are followed, the file must still be below the root.
  const auto [root_end, path_part] =
      std::mismatch(root.begin(), root.end(), path.begin(), path.end());
  if (root_end != root.end()) {
    return absl::InvalidArgumentError(
        StrCat("\"", bundle_path,
               "\" is a symbolic link that leads outside the scene's root; copy the "
               "file inside or choose a root that contains it (--root)"));
  }
  if (!fs::is_regular_file(path, error)) {
    return absl::InvalidArgumentError(StrCat("\"", bundle_path, "\" is no regular file"));
  }
  return path;
}

absl::StatusOr<std::string> ReadWholeFile(const std::filesystem::path& path, uint64_t limit) {
  std::error_code error;
  const uint64_t bytes = std::filesystem::file_size(path, error);
  if (error) return absl::NotFoundError(error.message());
  if (bytes > limit) {
    return absl::InvalidArgumentError(
        StrCat("the file has ", bytes, " bytes; at most ", limit, " are read"));
  }
  std::string text(bytes, '\0');
  std::ifstream file(path, std::ios::binary);
  if (!file.read(text.data(), static_cast<std::streamsize>(bytes))) {
    return absl::UnavailableError("the file cannot be read; check its permissions");
  }
  return IsGzip(text) ? Gunzip(text, limit) : std::move(text);
}

}  // namespace strata
