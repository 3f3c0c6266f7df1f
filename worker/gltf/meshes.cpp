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
                  const tinygltf::Primitive& primitive, std::string element)
      : document_(document),
        materials_(materials),
        primitive_(primitive),
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
    if (!primitive_.targets.empty())
      document_.Warn(element_ + ".targets", "morph targets are left out");
    if (!primitive_.attributes.contains("POSITION")) {
      document_.Warn(element_, "without positions it is left out");
      return std::nullopt;
    }
    STRATA_ASSIGN_OR_RETURN(mesh_.positions, Vectors("POSITION"));
    STRATA_RETURN_IF_ERROR(ReadTriangles(mode));
    if (mesh_.triangles.empty()) return std::nullopt;
    if (primitive_.attributes.contains("NORMAL")) {
      STRATA_ASSIGN_OR_RETURN(mesh_.normals, Vectors("NORMAL"));
      STRATA_RETURN_IF_ERROR(CheckCount("NORMAL", mesh_.normals.size()));
    }
    STRATA_ASSIGN_OR_RETURN(const int set, materials_.CoordinateSet(primitive_.material));
    STRATA_RETURN_IF_ERROR(ReadCoordinates(set));
    VertexColor colors;
    STRATA_RETURN_IF_ERROR(ReadColors(set >= 0, &colors));
    STRATA_ASSIGN_OR_RETURN(const SurfaceDescription surface,
                            materials_.Make(primitive_.material, colors));
    ShapeDescription shape;
    shape.where = document_.At(element_);
    shape.geometry = std::move(mesh_);
    shape.material = surface.material;
    shape.alpha = surface.alpha;
    shape.emission = surface.emission;
    return shape;
  }

 private:
  std::string ElementOf(const std::string& attribute) const {
    return element_ + ".attributes." + attribute;
  }

  absl::Status CheckCount(const std::string& attribute, size_t count) const {
    if (count == mesh_.positions.size()) return absl::OkStatus();
    return document_.Error(ElementOf(attribute), StrCat("it has ", count, " elements for ",
                                                        mesh_.positions.size(), " positions"));
  }

  absl::StatusOr<std::vector<Vec3f>> Vectors(const std::string& attribute) const {
    const std::string element = ElementOf(attribute);
    STRATA_ASSIGN_OR_RETURN(
        const FloatAttribute read,
        ReadFloats(document_, primitive_.attributes.at(attribute), 3, 3, element));
    std::vector<Vec3f> vectors(read.Count());
    for (size_t i = 0; i < vectors.size(); ++i) {
      vectors[i] = {read.values[3 * i], read.values[3 * i + 1], read.values[3 * i + 2]};
      if (!IsFinite(vectors[i]))
        return document_.Error(element, StrCat("element ", i, " is not finite"));
    }
    return vectors;
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
  absl::Status ReadCoordinates(int set) {
    if (set < 0) return absl::OkStatus();
    const std::string attribute = StrCat("TEXCOORD_", set);
    const auto found = primitive_.attributes.find(attribute);
    if (found == primitive_.attributes.end()) {
      document_.Warn(element_, StrCat("its material has textures, but it has no ", attribute,
                                      "; they are looked up at (0, 0)"));
      mesh_.uvs.assign(mesh_.positions.size(), {0, 1});
      return absl::OkStatus();
    }
    STRATA_ASSIGN_OR_RETURN(const FloatAttribute read,
                            ReadFloats(document_, found->second, 2, 2, ElementOf(attribute)));
    STRATA_RETURN_IF_ERROR(CheckCount(attribute, read.Count()));
    mesh_.uvs.resize(read.Count());
    for (size_t i = 0; i < mesh_.uvs.size(); ++i)
      mesh_.uvs[i] = {read.values[2 * i], 1 - read.values[2 * i + 1]};
    return absl::OkStatus();
  }

  absl::Status ReadColors(bool textured, VertexColor* colors) {
    const auto found = primitive_.attributes.find("COLOR_0");
    if (found == primitive_.attributes.end()) return absl::OkStatus();
    STRATA_ASSIGN_OR_RETURN(const FloatAttribute read,
                            ReadFloats(document_, found->second, 3, 4, ElementOf("COLOR_0")));
    STRATA_RETURN_IF_ERROR(CheckCount("COLOR_0", read.Count()));
    if (const std::optional<VertexColor> same = ConstantColor(read)) {
      *colors = *same;
    } else if (textured) {
      document_.Warn(ElementOf("COLOR_0"),
                     "vertex colours that vary are not supported beside textures and left out");
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
  const std::string element_;
  TriangleMeshShape mesh_;
};

}  // namespace

absl::StatusOr<std::vector<ShapeDescription>> MakeShapes(GltfDocument& document,
                                                         MaterialMaker& materials, int mesh) {
  STRATA_ASSIGN_OR_RETURN(const tinygltf::Mesh* found,
                          document.Find(document.model().meshes, mesh, "mesh", "nodes"));
  std::vector<ShapeDescription> shapes;
  for (size_t i = 0; i < found->primitives.size(); ++i) {
    const std::string element =
        StrCat(ElementName("meshes", mesh), ".", ElementName("primitives", static_cast<int>(i)));
    STRATA_ASSIGN_OR_RETURN(
        std::optional<ShapeDescription> shape,
        PrimitiveReader(document, materials, found->primitives[i], element).Read());
    if (shape) shapes.push_back(*std::move(shape));
  }
  return shapes;
}

}  // namespace strata
