#include "worker/geometry/builder.h"

#include <span>
#include <string>
#include <utility>
#include <variant>

#include "worker/geometry/alpha_mask.h"

namespace strata {
namespace {

absl::Status Located(const SourceLocation& where, const std::string& text) {
  return absl::InvalidArgumentError(absl::StrCat(where.ToString(), ": ", text));
}

/// What meshes and patches share: vertices with optional normals and uvs, placed in the group.
struct Vertices {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;
};

absl::StatusOr<Vertices> PlaceVertices(const ShapeDescription& shape,
                                       std::span<const Vec3f> positions,
                                       std::span<const Vec3f> normals, size_t uv_count,
                                       const Transform& to_group) {
  if (!normals.empty() && normals.size() != positions.size())
    return Located(shape.where, absl::StrCat("the mesh has ", positions.size(), " positions but ",
                                             normals.size(), " normals, give one for each"));
  if (uv_count != 0 && uv_count != positions.size())
    return Located(shape.where, absl::StrCat("the mesh has ", positions.size(), " positions but ",
                                             uv_count, " uvs, give one for each"));
  const std::optional<Transform> inverse = to_group.Inverse();
  if (!to_group.IsFinite() || !inverse)
    return Located(shape.where, "the shape's transform is singular, so it has no extent");
  Vertices vertices;
  vertices.positions.reserve(positions.size());
  for (size_t i = 0; i < positions.size(); ++i) {
    const Vec3f p = ToFloat(to_group.Point(ToDouble(positions[i])));
    if (!IsFinite(p))
      return Located(shape.where,
                     absl::StrCat("vertex ", i, " of the mesh lies at no finite place"));
    vertices.positions.push_back(p);
  }
  vertices.normals.reserve(normals.size());
  for (const Vec3f& normal : normals) {
    const Vec3d n = Normalize(Transform::Normal(*inverse, ToDouble(normal)));
    const Vec3f unit = ToFloat(shape.reverse_orientation ? -n : n);
    vertices.normals.push_back(IsFinite(unit) ? unit : Vec3f{});
  }
  return vertices;
}

absl::Status CheckIndices(const ShapeDescription& shape, std::span<const uint32_t> indices,
                          size_t positions) {
  for (const uint32_t index : indices) {
    if (index >= positions)
      return Located(shape.where, absl::StrCat("the mesh refers to vertex ", index, " but has ",
                                               positions, " vertices"));
  }
  return absl::OkStatus();
}

bool UsesSecondUv(const std::vector<TextureDescription>& textures, TextureId id) {
  if (id < 0 || static_cast<size_t>(id) >= textures.size()) return false;
  if (const auto* image = std::get_if<ImageTexture>(&textures[id])) return image->second_uv;
  const auto* product = std::get_if<ScaleTexture>(&textures[id]);
  return product &&
         (UsesSecondUv(textures, product->texture) || UsesSecondUv(textures, product->scale));
}

/// Those by which the shape's emission is looked up.
const std::vector<Vec2f>& EmissionUvs(const std::vector<TextureDescription>& textures,
                                      const ShapeDescription& shape,
                                      const TriangleMeshShape& mesh) {
  const bool second =
      shape.emission && !mesh.second_uvs.empty() && UsesSecondUv(textures, shape.emission->texture);
  return second ? mesh.second_uvs : mesh.uvs;
}

bool AllFinite(std::initializer_list<float> values) {
  for (const float value : values) {
    if (!std::isfinite(value)) return false;
  }
  return true;
}

}  // namespace

absl::Status ShapeBuilder::Add(const ShapeDescription& shape, const Transform& to_group,
                               bool may_emit, ShapeGroup* group) {
  if (shape.material < 0 || static_cast<size_t>(shape.material) >= scene_.materials.size())
    return Located(shape.where, "the shape has no material");
  // pbrt ignores the emission of interfaces too.
  if (std::holds_alternative<InterfaceMaterial>(scene_.materials[shape.material]))
    return absl::OkStatus();
  const Transform placed = to_group * shape.to_world;
  const auto check_radius = [&](float radius) {
    return radius > 0 ? absl::OkStatus()
                      : Located(shape.where,
                                absl::StrCat("the radius is ", radius, ", it must be positive"));
  };
  const auto check_finite = [&](std::initializer_list<float> values) {
    return AllFinite(values) ? absl::OkStatus()
                             : Located(shape.where, "the shape has a parameter that is not finite");
  };
  STRATA_RETURN_IF_ERROR(CheckAlpha(shape));
  if (IsCutAway(shape)) return absl::OkStatus();
  if (const auto* mesh = std::get_if<TriangleMeshShape>(&shape.geometry)) {
    if (!HasMask(shape)) return AddMesh(shape, *mesh, placed, may_emit, &group->triangles);
    STRATA_RETURN_IF_ERROR(AddMesh(shape, *mesh, placed, may_emit, &group->masked));
    group->masks.resize(group->masked.shapes.size(), shape.alpha);
    return absl::OkStatus();
  }
  if (const auto* patches = std::get_if<BilinearPatchShape>(&shape.geometry))
    return AddPatches(shape, *patches, placed, may_emit, group);
  if (const auto* curves = std::get_if<CurveShape>(&shape.geometry))
    return AddCurves(shape, *curves, placed, HasMask(shape), &group->curves);
  if (const auto* sphere = std::get_if<SphereShape>(&shape.geometry)) {
    STRATA_RETURN_IF_ERROR(check_radius(sphere->radius));
    STRATA_RETURN_IF_ERROR(
        check_finite({sphere->radius, sphere->z_min, sphere->z_max, sphere->phi_max}));
    return AddQuadric(shape, SphereSurface(*sphere), placed, may_emit, group);
  }
  if (const auto* disk = std::get_if<DiskShape>(&shape.geometry)) {
    STRATA_RETURN_IF_ERROR(check_radius(disk->radius));
    STRATA_RETURN_IF_ERROR(
        check_finite({disk->radius, disk->height, disk->inner_radius, disk->phi_max}));
    return AddQuadric(shape, DiskSurface(*disk), placed, may_emit, group);
  }
  const auto& cylinder = std::get<CylinderShape>(shape.geometry);
  STRATA_RETURN_IF_ERROR(check_radius(cylinder.radius));
  STRATA_RETURN_IF_ERROR(
      check_finite({cylinder.radius, cylinder.z_min, cylinder.z_max, cylinder.phi_max}));
  return AddQuadric(shape, CylinderSurface(cylinder), placed, may_emit, group);
}

std::optional<float> ShapeBuilder::ConstantAlpha(const ShapeDescription& shape) const {
  if (shape.alpha.texture == kNoTexture) return 1;
  const auto* constant = std::get_if<ConstantTexture>(&scene_.textures[shape.alpha.texture]);
  if (!constant) return std::nullopt;
  return AlphaAfterCutoff(shape.alpha, constant->value.r);
}

absl::Status ShapeBuilder::CheckAlpha(const ShapeDescription& shape) const {
  const TextureId id = shape.alpha.texture;
  if (id == kNoTexture || (id >= 0 && static_cast<size_t>(id) < scene_.textures.size()))
    return absl::OkStatus();
  return Located(shape.where,
                 absl::StrCat("the shape's alpha is texture ", id, ", which does not exist"));
}

bool ShapeBuilder::IsCutAway(const ShapeDescription& shape) const {
  const std::optional<float> alpha = ConstantAlpha(shape);
  return alpha && !(*alpha > 0);
}

bool ShapeBuilder::HasMask(const ShapeDescription& shape) const {
  const std::optional<float> alpha = ConstantAlpha(shape);
  return !alpha || *alpha < 1;
}

absl::Status ShapeBuilder::AddMesh(const ShapeDescription& shape, const TriangleMeshShape& mesh,
                                   const Transform& to_group, bool may_emit, TriangleSet* set) {
  STRATA_ASSIGN_OR_RETURN(
      const Vertices vertices,
      PlaceVertices(shape, mesh.positions, mesh.normals, mesh.uvs.size(), to_group));
  if (!mesh.second_uvs.empty() && mesh.second_uvs.size() != mesh.positions.size())
    return Located(shape.where, "the mesh has not as many second uvs as positions");
  constexpr size_t kMaxVertices = 0xfffffff0u;
  const size_t base = set->vertices.size();
  if (base + vertices.positions.size() > kMaxVertices ||
      set->triangles.size() + mesh.triangles.size() > kMaxVertices)
    return Located(shape.where, "the scene has more than four thousand million vertices");

  TriangleSet::Shape entry;
  entry.material = shape.material;
  entry.first_triangle = static_cast<uint32_t>(set->triangles.size());
  entry.parts = (vertices.normals.empty() ? 0 : TriangleSet::Shape::kNormals) |
                (mesh.uvs.empty() ? 0 : TriangleSet::Shape::kUvs) |
                (mesh.second_uvs.empty() ? 0 : TriangleSet::Shape::kSecondUvs);
  entry.second_uv_offset = static_cast<uint32_t>(set->second_uvs.size() - base);
  const bool mirrored = shape.reverse_orientation != to_group.SwapsHandedness();
  const std::vector<Vec2f>& emission_uvs = EmissionUvs(scene_.textures, shape, mesh);
  const bool emits = may_emit && shape.emission && !IsBlack(shape.emission->radiance);

  for (const auto& indices : mesh.triangles) {
    STRATA_RETURN_IF_ERROR(CheckIndices(shape, indices, vertices.positions.size()));
    const Vec3f p0 = vertices.positions[indices[0]];
    const Vec3f p1 = vertices.positions[indices[1]];
    const Vec3f p2 = vertices.positions[indices[2]];
    const Vec3f cross = Cross(p1 - p0, p2 - p0);
    if (cross == Vec3f{} || !IsFinite(cross)) continue;  // No area, or beyond float.
    Vec3f ng = NormalizeAny(cross).direction;
    bool flipped = mirrored;
    if (!vertices.normals.empty()) {
      // Vertex normals tell the outer side, for the triangle as a whole.
      const float side = Dot(ng, vertices.normals[indices[0]] + vertices.normals[indices[1]] +
                                     vertices.normals[indices[2]]);
      if (side != 0) flipped = side < 0;
    }
    if (flipped) ng = -ng;
    TriangleSet::Triangle triangle;
    for (int i = 0; i < 3; ++i) triangle.vertices[i] = static_cast<uint32_t>(base + indices[i]);
    triangle.shape = static_cast<uint32_t>(set->shapes.size());
    triangle.flipped = flipped;
    set->triangles.push_back(triangle);
    if (emits) {
      Emitter emitter;
      TriangleEmitter corners = {p0, p1, p2, ng};
      if (!emission_uvs.empty()) {
        corners.uv0 = emission_uvs[indices[0]];
        corners.uv1 = emission_uvs[indices[1]];
        corners.uv2 = emission_uvs[indices[2]];
      }
      emitter.shape = corners;
      emitter.area = static_cast<float>(
          0.5 * Length(Cross(ToDouble(p1) - ToDouble(p0), ToDouble(p2) - ToDouble(p0))));
      const int32_t light = AddEmitter(shape, std::move(emitter));
      if (entry.first_light < 0) entry.first_light = light;
    }
  }
  if (set->triangles.size() == entry.first_triangle) return absl::OkStatus();

  set->vertices.resize(base + vertices.positions.size());
  for (size_t i = 0; i < vertices.positions.size(); ++i) {
    const Vec2f uv = mesh.uvs.empty() ? Vec2f{} : mesh.uvs[i];
    const Vec3f n = vertices.normals.empty() ? Vec3f{} : vertices.normals[i];
    set->vertices[base + i] = {vertices.positions[i], uv.x, n, uv.y};
  }
  set->second_uvs.insert(set->second_uvs.end(), mesh.second_uvs.begin(), mesh.second_uvs.end());
  set->shapes.push_back(entry);
  return absl::OkStatus();
}

absl::Status ShapeBuilder::AddPatches(const ShapeDescription& shape,
                                      const BilinearPatchShape& patches, const Transform& to_group,
                                      bool may_emit, ShapeGroup* group) {
  STRATA_ASSIGN_OR_RETURN(
      const Vertices vertices,
      PlaceVertices(shape, patches.positions, patches.normals, patches.uvs.size(), to_group));
  for (const auto& indices : patches.patches) {
    STRATA_RETURN_IF_ERROR(CheckIndices(shape, indices, vertices.positions.size()));
    // An affine map of a patch is the patch of the mapped corners.
    BilinearPatchSurface patch;
    patch.has_normals = !vertices.normals.empty();
    Vec3d normal_sum;
    for (int i = 0; i < 4; ++i) {
      patch.p[i] = ToDouble(vertices.positions[indices[i]]);
      if (patch.has_normals) {
        patch.n[i] = ToDouble(vertices.normals[indices[i]]);
        normal_sum = normal_sum + patch.n[i];
      }
      if (!patches.uvs.empty()) {
        const Vec2f uv = patches.uvs[indices[i]];
        patch.uv[i] = {uv.x, uv.y};
      }
    }
    CurvedShape curved;
    curved.flipped = shape.reverse_orientation != to_group.SwapsHandedness();
    const double side = Dot(Cross(patch.DpDu(0.5), patch.DpDv(0.5)), normal_sum);
    if (side != 0) curved.flipped = side < 0;
    curved.surface = patch;
    AddCurved(shape, std::move(curved), may_emit, group);
  }
  return absl::OkStatus();
}

absl::Status ShapeBuilder::AddQuadric(const ShapeDescription& shape, CurvedSurface surface,
                                      const Transform& to_group, bool may_emit, ShapeGroup* group) {
  const std::optional<Placement> placement = Placement::From(to_group);
  if (!placement) return Located(shape.where, "the shape's transform is singular or not affine");
  CurvedShape curved;
  curved.surface = std::move(surface);
  curved.placement = *placement;
  curved.flipped = shape.reverse_orientation;
  AddCurved(shape, std::move(curved), may_emit, group);
  return absl::OkStatus();
}

void ShapeBuilder::AddCurved(const ShapeDescription& shape, CurvedShape curved, bool may_emit,
                             ShapeGroup* group) {
  if (!HasArea(curved)) return;
  curved.material = shape.material;
  if (HasMask(shape)) curved.alpha = shape.alpha;
  if (may_emit && shape.emission && !IsBlack(shape.emission->radiance)) {
    const double area = AreaOf(curved);
    if (!(area > 0) || !std::isfinite(area)) return;
    Emitter emitter;
    emitter.area = static_cast<float>(area);
    const Box box = BoundsOf(curved);
    OtherEmitter other = {static_cast<uint32_t>(group->curved.size()), ToFloat(box.min),
                          ToFloat(box.max)};
    other.flat = std::holds_alternative<DiskSurface>(curved.surface);
    if (other.flat) other.ng = SampleArea(curved, {0.5f, 0.5f}).ng;
    emitter.shape = other;
    const auto* sphere = std::get_if<SphereSurface>(&curved.surface);
    const std::optional<double> scale = curved.placement.UniformScale();
    if (sphere && sphere->IsFull() && scale) {
      emitter.shape =
          SphereEmitter{ToFloat(Placement::Point(curved.placement.to_world, {})),
                        static_cast<float>(sphere->radius * *scale), curved.flipped, other.shape};
    }
    curved.light = AddEmitter(shape, std::move(emitter));
  }
  group->curved.push_back(std::move(curved));
}

int32_t ShapeBuilder::AddEmitter(const ShapeDescription& shape, Emitter emitter) {
  emitter.radiance = shape.emission->radiance;
  emitter.two_sided = shape.emission->two_sided;
  emitter.texture = shape.emission->texture;
  emitter.masked = HasMask(shape);
  emitters_.push_back(std::move(emitter));
  return static_cast<int32_t>(emitters_.size() - 1);
}

}  // namespace strata
