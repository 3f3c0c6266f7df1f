#include "cli/scene_images.h"

#include <fcntl.h>
#include <unistd.h>

#include <map>
#include <optional>
#include <string>
#include <variant>

#include "common/image_file.h"
#include "worker/geometry/image_texels.h"
#include "worker/light/light_files.h"

namespace strata {
namespace {

/// Where an image is named, and the texture that uses it: what a light's may hold is checked with
/// the light.
using Images = std::map<std::string, const ImageTexture*>;

Images ImagesOf(const SceneDescription& scene) {
  Images images;
  for (const LightDescription& light : scene.lights) {
    if (const std::optional<std::string> path = LightImagePath(light)) images[*path] = nullptr;
  }
  for (const TextureDescription& texture : scene.textures) {
    if (const auto* image = std::get_if<ImageTexture>(&texture)) images[image->path] = image;
  }
  return images;
}

/// While one lives, nothing written to standard error is seen. libpng reports to it on its own what
/// is reported here, and bad input is to be told in one line.
class SilencedStandardError {
 public:
  SilencedStandardError() : kept_(fcntl(STDERR_FILENO, F_DUPFD_CLOEXEC, 0)) {
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && nowhere >= 0) dup2(nowhere, STDERR_FILENO);
    if (nowhere >= 0) close(nowhere);
  }
  ~SilencedStandardError() {
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  SilencedStandardError(const SilencedStandardError&) = delete;
  SilencedStandardError& operator=(const SilencedStandardError&) = delete;

 private:
  int kept_;  ///< Where standard error leads, or -1 when it is closed.
};

}  // namespace

absl::Status CheckImages(const LoadedScene& loaded) {
  const SceneDescription& scene = loaded.file.scene;
  const SilencedStandardError silenced;
  const DirectorySource source = loaded.path.Source();
  for (const auto& [name, texture] : ImagesOf(scene)) {
    const bool embedded = texture && texture->embedded;
    // By the path as typed, which the error then names; that it stays inside the root is known.
    const std::filesystem::path path = loaded.path.Typed(name);
    const absl::StatusOr<ImageFile> file =
        embedded ? ReadTextureImage(*texture, source) : ReadImageFile(path);
    if (!file.ok()) {
      const std::string what = std::string(file.status().message());
      return absl::InvalidArgumentError(absl::StrCat(embedded ? loaded.path.Located(what) : what,
                                                     "; replace it with a whole image"));
    }
    const absl::Status usable = texture ? CheckTexels(*file, false) : absl::OkStatus();
    if (!usable.ok()) {
      return absl::InvalidArgumentError(
          absl::StrCat(path.string(), ": ", usable.message(), "; mend or replace it"));
    }
  }
  for (const LightDescription& light : scene.lights) {
    const absl::Status fits = CheckLightFile(light, source);
    if (!fits.ok()) {
      return absl::InvalidArgumentError(
          loaded.path.Located(absl::StrCat(light.where.ToString(), ": ", fits.message())));
    }
  }
  return absl::OkStatus();
}

}  // namespace strata
