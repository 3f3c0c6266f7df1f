#include "worker/pbrt/reader.h"

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "worker/pbrt/mesh_files.h"
#include "worker/pbrt/scene_parser.h"

namespace strata {

absl::StatusOr<PbrtScene> ReadPbrt(const FileSource& source, const std::string& scene_path) {
  if (!IsBundlePath(scene_path)) {
    return absl::InvalidArgumentError(
        StrCat("the scene \"", scene_path, "\" must be a path relative to its root"));
  }
  STRATA_RETURN_IF_ERROR(source.Locate(scene_path).status());
  ReadContext context(source, scene_path);
  context.files.insert(scene_path);
  STRATA_RETURN_IF_ERROR(SceneParser(context).ParseFile(scene_path));
  const UnusedParts unused = RemoveUnused(&context.scene);
  STRATA_RETURN_IF_ERROR(ReadMeshFiles(context));
  for (const TextureDescription& texture : context.scene.textures) {
    if (const auto* image = std::get_if<ImageTexture>(&texture))
      STRATA_RETURN_IF_ERROR(context.AddNamedFile(image->path, image->where));
  }
  return PbrtScene{std::move(context.scene),
                   context.warnings.Take(),
                   {context.files.begin(), context.files.end()},
                   unused};
}

absl::StatusOr<Bundle> MakeBundle(const FileSource& source, const std::string& scene_path,
                                  const std::vector<std::string>& files) {
  Bundle bundle;
  bundle.scene = scene_path;
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
