#include "common/bundle.h"

#include <absl/strings/str_split.h>

#include <algorithm>
#include <filesystem>
#include <span>

#include "common/text.h"

namespace strata {
namespace {

void UpdateWithNumber(Sha256& sha, uint64_t number) {
  std::array<std::byte, 8> bytes;
  for (std::byte& byte : bytes) {
    byte = static_cast<std::byte>(number & 0xff);
    number >>= 8;
  }
  sha.Update(bytes);
}

void UpdateWithText(Sha256& sha, std::string_view text) {
  UpdateWithNumber(sha, text.size());
  sha.Update(text);
}

bool HasControlCharacter(std::string_view text) {
  return std::any_of(text.begin(), text.end(),
                     [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
}

}  // namespace

bool IsBundlePath(std::string_view path) {
  if (path.empty() || path.size() > 4096 || HasControlCharacter(path)) return false;
  for (const absl::string_view part : absl::StrSplit(ToAbsl(path), '/')) {
    if (part.empty() || part == "." || part == "..") return false;
  }
  return true;
}

absl::StatusOr<std::string> ResolveBundlePath(std::string_view directory, std::string_view name) {
  if (name.empty()) return absl::InvalidArgumentError("the file name is empty");
  if (name.front() == '/') {
    return absl::InvalidArgumentError(
        StrCat("\"", std::string(name),
               "\" is an absolute path; name it relative to the scene's main file"));
  }
  const std::string path =
      (std::filesystem::path(directory) / name).lexically_normal().generic_string();
  if (!IsBundlePath(path)) {
    return absl::InvalidArgumentError(
        StrCat("\"", std::string(name),
               "\" leads outside the scene's root; move it inside or choose a root that "
               "contains it (--root)"));
  }
  return path;
}

absl::Status ValidateBundle(const Bundle& bundle) {
  bool has_scene = false;
  for (size_t i = 0; i < bundle.files.size(); ++i) {
    const std::string& path = bundle.files[i].path;
    if (!IsBundlePath(path)) {
      return absl::InvalidArgumentError(StrCat(
          "bundle path \"", path, "\" must be relative, without empty, \".\" or \"..\" parts"));
    }
    if (i > 0 && !(bundle.files[i - 1].path < path)) {
      return absl::InvalidArgumentError(
          StrCat("bundle path \"", path, "\" is out of order or named twice"));
    }
    has_scene |= path == bundle.scene;
  }
  const SceneOptions& options = bundle.options;
  const bool has_environment =
      options.environment.empty() ||
      std::any_of(bundle.files.begin(), bundle.files.end(),
                  [&](const BundleFile& file) { return file.path == options.environment; });
  if (!has_environment) {
    return absl::InvalidArgumentError(
        StrCat("the environment \"", options.environment, "\" is not one of the bundle's files"));
  }
  constexpr size_t kMaxCameraBytes = 1024;
  if (options.camera.size() > kMaxCameraBytes || HasControlCharacter(options.camera)) {
    return absl::InvalidArgumentError(
        "the camera's name is longer than 1024 bytes or holds a control character");
  }
  if (!has_scene) {
    return absl::InvalidArgumentError(
        StrCat("the bundle's scene \"", bundle.scene, "\" is not one of its files"));
  }
  return absl::OkStatus();
}

Digest BundleDigest(const Bundle& bundle) {
  Sha256 sha;
  UpdateWithText(sha, bundle.scene);
  UpdateWithNumber(sha, bundle.files.size());
  for (const BundleFile& file : bundle.files) {
    UpdateWithText(sha, file.path);
    sha.Update(std::as_bytes(std::span(file.digest.bytes)));
  }
  // Scenes without options keep the digest they had before there were any.
  if (bundle.options != SceneOptions{}) {
    UpdateWithText(sha, bundle.options.environment);
    UpdateWithText(sha, bundle.options.camera);
  }
  if (bundle.options.light_selection != LightSelection::kTree)
    UpdateWithNumber(sha, static_cast<uint64_t>(bundle.options.light_selection));
  return sha.Finish();
}

}  // namespace strata
