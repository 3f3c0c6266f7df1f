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

}  // namespace strata
