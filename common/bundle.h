#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/digest.h"
#include "common/status.h"

namespace strata {

/// One file a scene needs: where the scene says it is, and what it holds.
struct BundleFile {
  std::string path;  ///< Relative to the bundle's root, '/' separated, no "." or "..".
  Digest digest;
  uint64_t bytes = 0;
  bool operator==(const BundleFile&) const = default;
};

/// How one light of many is chosen. All but the tree are there to be compared with.
enum class LightSelection : uint8_t {
  kTree,       ///< By what each may bring to the point (PBRT 12.6.3).
  kIntensity,  ///< By its intensity alone (PBRT 12.6.2).
  kUniform     ///< All alike (PBRT 12.6.1).
};

/// What a job says of its scene beside the files.
struct SceneOptions {
  std::string environment;  ///< An image among the files, in place of infinite lights; or empty.
  /// In place of the file's camera, or empty: numbers as ParseViewpoint reads them
  /// (worker/scene/scene_options.h), or what the file calls one of its cameras.
  std::string camera;
  LightSelection light_selection = LightSelection::kTree;
  bool operator==(const SceneOptions&) const = default;
};

/// All files of a scene, by content. It never names a path outside itself.
struct Bundle {
  std::string scene;              ///< The path of the scene's main file, one of `files`.
  std::vector<BundleFile> files;  ///< Sorted by path, no path twice.
  SceneOptions options;
  bool operator==(const Bundle&) const = default;
};

/// True for a path a bundle may hold: relative, '/' separated, without empty, "." or ".." parts and
/// control characters.
bool IsBundlePath(std::string_view path);

/// The bundle path of `name`, which is relative to the bundle's `directory` ("" for its root).
/// INVALID_ARGUMENT when it is absolute or leads outside the root.
absl::StatusOr<std::string> ResolveBundlePath(std::string_view directory, std::string_view name);

/// INVALID_ARGUMENT with the offending path when the rules above are broken.
absl::Status ValidateBundle(const Bundle& bundle);

/// Names the scene: the digest over the paths and contents of all files, and the options.
Digest BundleDigest(const Bundle& bundle);

}  // namespace strata
