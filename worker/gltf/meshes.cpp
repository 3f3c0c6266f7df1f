#include "worker/gltf/meshes.h"

#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "common/text.h"
#include "worker/gltf/accessors.h"
#include "worker/gltf/vertex_colors.h"

namespace strata {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

/// The triangles of `indices` in one of glTF's modes (3.7.2.1). Of strips every second triangle is
/// turned, so that all are seen from the same side.
Triangles Assemble(const std::vector<uint32_t>& indices, int mode) {
  Triangles triangles;
  const size_t count = indices.size();
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    for (size_t i = 0; i + 2 < count; i += 3)
      triangles.push_back({indices[i], indices[i + 1], indices[i + 2]});
  } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (size_t i = 0; i + 2 < count; ++i)
      triangles.push_back({indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]});
  } else {
    for (size_t i = 1; i + 1 < count; ++i)
      triangles.push_back({indices[i], indices[i + 1], indices[0]});
  }
  return triangles;
}

/// Reads one primitive.
class PrimitiveReader {
 public:
  PrimitiveReader(GltfDocument& document, MaterialMaker& materials,
                  const tinygltf::Primitive& primitive, const MeshPose& pose, std::string element)
      : document_(document),
        materials_(materials),
        primitive_(primitive),
        pose_(pose),
        element_(std::move(element)) {}

  /// None where there is nothing to see.
  absl::StatusOr<std::optional<ShapeDescription>> Read() {
    const int mode = primitive_.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive_.mode;
    if (mode < TINYGLTF_MODE_TRIANGLES || mode > TINYGLTF_MODE_TRIANGLE_FAN) {
      if (mode > TINYGLTF_MODE_TRIANGLE_FAN)
        return document_.Error(element_ + ".mode", StrCat(mode, " is no mode"));
      document_.Warn(element_, "points and lines have no surface and are left out");
      return std::nullopt;
    }
    if (!primitive_.attributes.contains("POSITION")) {
      document_.Warn(element_, "without positions it is left out");
      return std::nullopt;
    }
    STRATA_RETURN_IF_ERROR(CheckUncompressed());
    STRATA_ASSIGN_OR_RETURN(mesh_.positions, Vectors("POSITION"));
    STRATA_RETURN_IF_ERROR(ReadTriangles(mode));
    if (mesh_.triangles.empty()) return std::nullopt;
    if (primitive_.attributes.contains("NORMAL")) {
      STRATA_ASSIGN_OR_RETURN(mesh_.normals, Vectors("NORMAL"));
      STRATA_RETURN_IF_ERROR(CheckCount("NORMAL", mesh_.normals.size()));
    }
    STRATA_RETURN_IF_ERROR(ApplyPose(document_, primitive_, pose_, element_, &mesh_));
    STRATA_ASSIGN_OR_RETURN(const CoordinateSets sets,
                            materials_.CoordinatesOf(primitive_.material));
    STRATA_RETURN_IF_ERROR(ReadCoordinates(sets.first, &mesh_.uvs));
    STRATA_RETURN_IF_ERROR(ReadCoordinates(sets.second, &mesh_.second_uvs));
    VertexColor colors;
    STRATA_RETURN_IF_ERROR(ReadColors(sets, &colors));
    STRATA_ASSIGN_OR_RETURN(const SurfaceDescription surface,
                            materials_.Make(primitive_.material, colors));
    ShapeDescription shape;
    shape.where = document_.At(element_);
    shape.geometry = std::move(mesh_);
    shape.material = surface.material;
    shape.alpha = surface.alpha;
    shape.emission = surface.emission;
    shape.border = surface.border;
    return shape;
  }

 private:
  std::string ElementOf(const std::string& attribute) const {
    return element_ + ".attributes." + attribute;
  }

  /// Accessors without a buffer are full of zeros, but where the data are compressed.
  absl::Status CheckUncompressed() const {
    constexpr const char* kDraco = "KHR_draco_mesh_compression";
    if (!primitive_.extensions.contains(kDraco)) return absl::OkStatus();
    const std::string element = ElementOf("POSITION");
    STRATA_ASSIGN_OR_RETURN(
        const tinygltf::Accessor* positions,
        document_.Find(document_.model().accessors, primitive_.attributes.at("POSITION"),
                       "accessor", element));
    if (positions->bufferView >= 0) return absl::OkStatus();
    return document_.Error(
        StrCat(element_, ".extensions.", kDraco),
        "it is not supported, and there is no uncompressed copy; write the file uncompressed");
  }

  absl::Status CheckCount(const std::string& attribute, size_t count) const {
    if (count == mesh_.positions.size()) return absl::OkStatus();
    return document_.Error(ElementOf(attribute), StrCat("it has ", count, " elements for ",
                                                        mesh_.positions.size(), " positions"));
  }

  absl::StatusOr<std::vector<Vec3f>> Vectors(const std::string& attribute) const {
    return ReadVectors(document_, primitive_.attributes.at(attribute), ElementOf(attribute));
  }

  absl::Status ReadTriangles(int mode) {
    std::vector<uint32_t> indices(mesh_.positions.size());
    if (primitive_.indices >= 0) {
      STRATA_ASSIGN_OR_RETURN(indices,
                              ReadIndices(document_, primitive_.indices, element_ + ".indices"));
    } else {
      std::iota(indices.begin(), indices.end(), 0);
    }
    for (const uint32_t index : indices) {
      if (index >= mesh_.positions.size())
        return document_.Error(element_ + ".indices",
                               StrCat("it names vertex ", index, " of ", mesh_.positions.size()));
    }
    if (mode == TINYGLTF_MODE_TRIANGLES && indices.size() % 3 != 0)
      document_.Warn(element_, "the last triangle has less than three corners and is left out");
    mesh_.triangles = Assemble(indices, mode);
    return absl::OkStatus();
  }

  /// glTF's v points down in the image, ours up.
  absl::Status ReadCoordinates(int set, std::vector<Vec2f>* uvs) {
    if (set < 0) return absl::OkStatus();
    const std::string attribute = StrCat("TEXCOORD_", set);
    const auto found = primitive_.attributes.find(attribute);
    if (found == primitive_.attributes.end()) {
      document_.Warn(element_, StrCat("its material has textures, but it has no ", attribute,
                                      "; they are looked up at (0, 0)"));
      uvs->assign(mesh_.positions.size(), {0, 1});
      return absl::OkStatus();
    }
    STRATA_ASSIGN_OR_RETURN(const FloatAttribute read,
                            ReadFloats(document_, found->second, 2, 2, ElementOf(attribute)));
    STRATA_RETURN_IF_ERROR(CheckCount(attribute, read.Count()));
    uvs->resize(read.Count());
    for (size_t i = 0; i < uvs->size(); ++i)
      (*uvs)[i] = {read.values[2 * i], 1 - read.values[2 * i + 1]};
    return absl::OkStatus();
  }

  absl::Status ReadColors(const CoordinateSets& sets, VertexColor* colors) {
    const auto found = primitive_.attributes.find("COLOR_0");
    if (found == primitive_.attributes.end()) return absl::OkStatus();
    STRATA_ASSIGN_OR_RETURN(const FloatAttribute read,
                            ReadFloats(document_, found->second, 3, 4, ElementOf("COLOR_0")));
    STRATA_RETURN_IF_ERROR(CheckCount("COLOR_0", read.Count()));
    STRATA_ASSIGN_OR_RETURN(const bool unlit, materials_.IsUnlit(primitive_.material));
    if (const std::optional<VertexColor> same = ConstantColor(read)) {
      *colors = *same;
    } else if (sets.second >= 0) {
      document_.Warn(ElementOf("COLOR_0"),
                     "vertex colours that vary are not supported beside two sets of texture "
                     "coordinates and left out");
    } else if (sets.first >= 0 && unlit) {
      document_.Warn(ElementOf("COLOR_0"),
                     "vertex colours that vary are not supported beside the texture of an unlit "
                     "material and left out");
    } else if (mesh_.triangles.size() > kMaxColoredTriangles) {
      document_.Warn(ElementOf("COLOR_0"), "vertex colours of so many triangles are left out");
    } else {
      *colors =
          PaintTriangles(read, document_.At(ElementOf("COLOR_0")), &mesh_, materials_.textures());
    }
    return absl::OkStatus();
  }

  GltfDocument& document_;
  MaterialMaker& materials_;
  const tinygltf::Primitive& primitive_;
  const MeshPose& pose_;
  const std::string element_;
  TriangleMeshShape mesh_;
};

}  // namespace

absl::StatusOr<std::vector<ShapeDescription>> MakeShapes(GltfDocument& document,
                                                         MaterialMaker& materials, int mesh,
                                                         const MeshPose& pose) {
  STRATA_ASSIGN_OR_RETURN(const tinygltf::Mesh* found,
                          document.Find(document.model().meshes, mesh, "mesh", "nodes"));
  std::vector<ShapeDescription> shapes;
  for (size_t i = 0; i < found->primitives.size(); ++i) {
    const std::string element =
        StrCat(ElementName("meshes", mesh), ".", ElementName("primitives", static_cast<int>(i)));
    STRATA_ASSIGN_OR_RETURN(
        std::optional<ShapeDescription> shape,
        PrimitiveReader(document, materials, found->primitives[i], pose, element).Read());
    if (shape) shapes.push_back(*std::move(shape));
  }
  return shapes;
}

}  // namespace strata
