#include "worker/scene/scene_file.h"

#include <absl/strings/match.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "common/text.h"
#include "worker/gltf/reader.h"
#include "worker/pbrt/reader.h"
#include "worker/scene/scene_options.h"

namespace strata {

absl::StatusOr<SceneFile> ReadSceneFile(const FileSource& source, const std::string& scene_path,
                                        const SceneOptions& options) {
  const bool gltf = IsGltfPath(scene_path);
  STRATA_ASSIGN_OR_RETURN(
      SceneFile file, gltf ? ReadGltf(source, scene_path, options) : ReadPbrt(source, scene_path));
  if (!options.camera.empty() && !gltf)
    STRATA_RETURN_IF_ERROR(SetViewpoint(options.camera, &file.scene));
  if (!options.environment.empty())
    STRATA_RETURN_IF_ERROR(SetEnvironment(source, options.environment, &file));
  return file;
}

absl::StatusOr<Bundle> MakeBundle(const FileSource& source, const std::string& scene_path,
                                  const std::vector<std::string>& files,
                                  const SceneOptions& options) {
  Bundle bundle;
  bundle.scene = scene_path;
  bundle.options = options;
  for (const std::string& path : files) {
    STRATA_ASSIGN_OR_RETURN(const std::filesystem::path local, source.Locate(path));
    BundleFile file;
    file.path = path;
    std::error_code error;
    file.bytes = std::filesystem::file_size(local, error);
    if (error) return absl::NotFoundError(StrCat("\"", path, "\": ", error.message()));
    STRATA_ASSIGN_OR_RETURN(file.digest, DigestOfFile(local));
    bundle.files.push_back(std::move(file));
  }
  std::sort(bundle.files.begin(), bundle.files.end(),
            [](const BundleFile& a, const BundleFile& b) { return a.path < b.path; });
  STRATA_RETURN_IF_ERROR(ValidateBundle(bundle));
  return bundle;
}

}  // namespace strata
