#include "worker/pbrt/mesh_files.h"

#include <tbb/parallel_for.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "worker/pbrt/entities.h"
#include "worker/pbrt/ply.h"

namespace strata {
namespace {

constexpr uint64_t kMaxPlyBytes = uint64_t{16} << 30;

/// A shape whose mesh is in a file, and what came of reading it.
struct UnreadMesh {
  ShapeDescription* shape;
  std::filesystem::path local;
  absl::Status status;
};

/// The file of a shape, which becomes one the scene needs. None if it has been read or has no file.
absl::StatusOr<std::optional<UnreadMesh>> FileOf(ShapeDescription* shape, ReadContext& context) {
  const auto* mesh = std::get_if<TriangleMeshShape>(&shape->geometry);
  if (!mesh || mesh->unread_file.empty()) return std::nullopt;
  STRATA_RETURN_IF_ERROR(context.AddNamedFile(mesh->unread_file, shape->where));
  STRATA_ASSIGN_OR_RETURN(std::filesystem::path local,
                          context.Locate(mesh->unread_file, shape->where));
  return UnreadMesh{shape, std::move(local), absl::OkStatus()};
}

/// Touches nothing but the shape.
absl::Status Read(const UnreadMesh& unread) {
  ShapeDescription& shape = *unread.shape;
  const std::string path = std::get<TriangleMeshShape>(shape.geometry).unread_file;
  const absl::StatusOr<std::string> bytes = ReadWholeFile(unread.local, kMaxPlyBytes);
  absl::StatusOr<TriangleMeshShape> mesh =
      bytes.ok() ? ParsePly(*bytes) : absl::StatusOr<TriangleMeshShape>(bytes.status());
  if (!mesh.ok())
    return Annotate(mesh.status(), StrCat(shape.where.ToString(), ": \"", path, "\""));
  shape.geometry = *std::move(mesh);
  return CheckPlacement(shape.geometry, shape.to_world, shape.where);
}

template <typename F>
void ForEachShapeList(SceneDescription& scene, F f) {
  f(scene.shapes);
  for (ObjectDescription& object : scene.objects) f(object.shapes);
}

}  // namespace

absl::Status ReadMeshFile(ShapeDescription* shape, ReadContext& context) {
  STRATA_ASSIGN_OR_RETURN(const std::optional<UnreadMesh> unread, FileOf(shape, context));
  return unread ? Read(*unread) : absl::OkStatus();
}

absl::Status ReadMeshFiles(ReadContext& context) {
  std::vector<UnreadMesh> all;
  absl::Status missing;
  ForEachShapeList(context.scene, [&](std::vector<ShapeDescription>& shapes) {
    for (ShapeDescription& shape : shapes) {
      absl::StatusOr<std::optional<UnreadMesh>> unread = FileOf(&shape, context);
      missing.Update(unread.status());
      if (unread.ok() && *unread) all.push_back(**std::move(unread));
    }
  });
  STRATA_RETURN_IF_ERROR(missing);
  tbb::parallel_for(size_t{0}, all.size(), [&](size_t i) { all[i].status = Read(all[i]); });
  for (const UnreadMesh& mesh : all) STRATA_RETURN_IF_ERROR(mesh.status);
  ForEachShapeList(context.scene, [&](std::vector<ShapeDescription>& shapes) {
    std::erase_if(shapes, [&](const ShapeDescription& shape) {
      if (!IsWithoutFaces(shape.geometry)) return false;
      WarnWithoutFaces(shape.where, context);
      return true;
    });
  });
  return absl::OkStatus();
}

}  // namespace strata
