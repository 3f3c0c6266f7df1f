#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "worker/geometry/loop_subdivision.h"
#include "worker/pbrt/entities.h"
#include "worker/scene/recentre.h"

namespace strata {
namespace {

/// Vertex indices as given, or 0 .. `corners` - 1 where the vertices are just one primitive's.
std::vector<int> ReadIndices(ParameterReader& parameters, size_t vertices, int corners) {
  std::vector<int> indices = parameters.Integers("indices");
  if (!parameters.Has("indices") && vertices == static_cast<size_t>(corners)) {
    for (int i = 0; i < corners; ++i) indices.push_back(i);
  }
  if (indices.empty()) {
    parameters.Fail(parameters.where(), "the mesh wants \"integer indices\"");
  } else if (indices.size() % corners != 0) {
    parameters.Fail(parameters.where(), StrCat("the mesh has ", indices.size(),
                                               " indices, which is no multiple of ", corners));
  }
  for (const int index : indices) {
    if (index >= 0 && static_cast<size_t>(index) < vertices) continue;
    parameters.Fail(parameters.where(), StrCat("the mesh has the vertex index ", index, ", but ",
                                               vertices, " vertices"));
    break;
  }
  return parameters.ok() ? indices : std::vector<int>();
}

template <typename Mesh>
void ReadVertices(ParameterReader& parameters, Mesh& mesh) {
  mesh.positions = parameters.Point3s("P");
  mesh.normals = parameters.Normals("N");
  mesh.uvs = parameters.Point2s("uv");
  parameters.Ignore("faceIndices");
  if (mesh.positions.empty()) {
    parameters.Fail(parameters.where(), "the mesh wants vertex positions \"point3 P\"");
  }
  const auto check = [&](size_t count, std::string_view name) {
    if (count == 0 || count == mesh.positions.size()) return;
    parameters.Fail(parameters.where(),
                    StrCat("the mesh has ", mesh.positions.size(), " positions, but ", count,
                           " of \"", name, "\"; give one for each"));
  };
  check(mesh.normals.size(), "N");
  check(mesh.uvs.size(), "uv");
}

TriangleMeshShape ReadTriangleMesh(ParameterReader& parameters) {
  TriangleMeshShape mesh;
  ReadVertices(parameters, mesh);
  parameters.Ignore("S");  // tangents, of use to anisotropic hair alone
  const std::vector<int> indices = ReadIndices(parameters, mesh.positions.size(), 3);
  mesh.triangles.reserve(indices.size() / 3);
  for (size_t i = 0; i + 2 < indices.size(); i += 3) {
    mesh.triangles.push_back({static_cast<uint32_t>(indices[i]),
                              static_cast<uint32_t>(indices[i + 1]),
                              static_cast<uint32_t>(indices[i + 2])});
  }
  return mesh;
}

BilinearPatchShape ReadBilinearMesh(ParameterReader& parameters) {
  BilinearPatchShape mesh;
  ReadVertices(parameters, mesh);
  parameters.Ignore("emissionfilename");  // says where pbrt samples an area light's image most
  const std::vector<int> indices = ReadIndices(parameters, mesh.positions.size(), 4);
  for (size_t i = 0; i + 3 < indices.size(); i += 4) {
    std::array<uint32_t, 4> patch;
    std::copy_n(indices.begin() + i, 4, patch.begin());
    mesh.patches.push_back(patch);
  }
  return mesh;
}

/// Only names the file: it is read when all of the scene is known, and if the shape is needed.
absl::StatusOr<TriangleMeshShape> ReadPlyMesh(ParameterReader& parameters,
                                              const ReadContext& context) {
  const SourceLocation& where = parameters.where();
  if (!parameters.Has("filename")) {
    return ErrorAt(where, "Shape \"plymesh\" wants a \"string filename\"");
  }
  const std::string name = parameters.String("filename", "");
  parameters.Float("edgelength", 1);  // of displacement alone
  TriangleMeshShape mesh;
  STRATA_ASSIGN_OR_RETURN(mesh.unread_file, context.NameFile(name, where));
  return mesh;
}

/// The limit surface of a control mesh, as a mesh of its own.
absl::StatusOr<ShapeGeometry> ReadLoopSubdivision(ParameterReader& parameters) {
  TriangleMeshShape control;
  control.positions = parameters.Point3s("P");
  const int levels = parameters.Integer("levels", 3);
  for (const char* name : {"scheme", "N", "uv"}) parameters.Ignore(name);  // as pbrt does
  const std::vector<int> indices = ReadIndices(parameters, control.positions.size(), 3);
  for (size_t i = 0; i + 2 < indices.size(); i += 3) {
    control.triangles.push_back({static_cast<uint32_t>(indices[i]),
                                 static_cast<uint32_t>(indices[i + 1]),
                                 static_cast<uint32_t>(indices[i + 2])});
  }
  if (!parameters.ok()) return control;
  absl::StatusOr<TriangleMeshShape> mesh = LoopSubdivide(control, levels);
  if (!mesh.ok()) return Annotate(mesh.status(), parameters.where().ToString());
  return *std::move(mesh);
}

float Positive(ParameterReader& parameters, std::string_view name, double fallback) {
  const double value = parameters.Float(name, fallback);
  if (!(static_cast<float>(value) > 0)) {
    parameters.Fail(parameters.where(),
                    StrCat("\"float ", name, "\" must be more than 0, not ", value));
  }
  return static_cast<float>(value);
}

float PhiMax(ParameterReader& parameters) {
  const float phi_max = Positive(parameters, "phimax", 360);
  return std::min(phi_max, 360.0f);
}

void CheckHeights(ParameterReader& parameters, float z_min, float z_max) {
  if (z_min == z_max) {
    parameters.Fail(parameters.where(), "\"zmin\" and \"zmax\" are equal; the shape is empty");
  }
}

SphereShape ReadSphere(ParameterReader& parameters) {
  SphereShape sphere;
  sphere.radius = Positive(parameters, "radius", 1);
  const auto height = [&](std::string_view name, float fallback) {
    return std::clamp(static_cast<float>(parameters.Float(name, fallback)),
                      -std::fabs(sphere.radius), std::fabs(sphere.radius));
  };
  const float a = height("zmin", -sphere.radius), b = height("zmax", sphere.radius);
  sphere.z_min = std::min(a, b);
  sphere.z_max = std::max(a, b);
  sphere.phi_max = PhiMax(parameters);
  CheckHeights(parameters, sphere.z_min, sphere.z_max);
  return sphere;
}

DiskShape ReadDisk(ParameterReader& parameters) {
  DiskShape disk;
  disk.height = static_cast<float>(parameters.Float("height", 0));
  disk.radius = Positive(parameters, "radius", 1);
  disk.inner_radius = static_cast<float>(parameters.Float("innerradius", 0));
  disk.phi_max = PhiMax(parameters);
  if (!(disk.inner_radius >= 0 && disk.inner_radius < disk.radius)) {
    parameters.Fail(parameters.where(), "\"innerradius\" must be 0 or more and below \"radius\"");
  }
  return disk;
}

CylinderShape ReadCylinder(ParameterReader& parameters) {
  CylinderShape cylinder;
  cylinder.radius = Positive(parameters, "radius", 1);
  const float a = static_cast<float>(parameters.Float("zmin", -1));
  const float b = static_cast<float>(parameters.Float("zmax", 1));
  cylinder.z_min = std::min(a, b);
  cylinder.z_max = std::max(a, b);
  cylinder.phi_max = PhiMax(parameters);
  CheckHeights(parameters, cylinder.z_min, cylinder.z_max);
  return cylinder;
}

absl::StatusOr<ShapeGeometry> ReadGeometry(const std::string& type, ParameterReader& parameters,
                                           ReadContext& context) {
  if (type == "trianglemesh") return ReadTriangleMesh(parameters);
  if (type == "plymesh") return ReadPlyMesh(parameters, context);
  if (type == "bilinearmesh") return ReadBilinearMesh(parameters);
  if (type == "sphere") return ReadSphere(parameters);
  if (type == "disk") return ReadDisk(parameters);
  if (type == "cylinder") return ReadCylinder(parameters);
  if (type == "curve") return ReadCurve(parameters);
  if (type == "loopsubdiv") return ReadLoopSubdivision(parameters);
  return ErrorAt(parameters.where(), StrCat("unknown Shape \"", type, "\""));
}

bool FitsFloat(Vec3d p) {
  const auto fits = [](double x) { return std::fabs(x) <= std::numeric_limits<float>::max() / 4; };
  return fits(p.x) && fits(p.y) && fits(p.z);
}

}  // namespace

std::optional<AlphaMask> ReadAlpha(ParameterReader& parameters, bool emissive,
                                   TextureTable& textures, ReadContext& context) {
  const TextureId alpha = textures.Float(parameters, "alpha", std::nullopt);
  const std::optional<Rgb> constant = textures.ConstantValue(alpha);
  if (!constant) return AlphaMask{alpha};
  if (constant->r > 0) return constant->r < 1 ? AlphaMask{alpha} : AlphaMask{};
  if (!emissive) return std::nullopt;
  context.Warn(parameters.where(),
               "lights that are not seen are not supported; the shape of alpha 0 is opaque");
  return AlphaMask{};
}

absl::StatusOr<std::optional<ShapeGeometry>> ReadShape(const std::string& type,
                                                       ParameterReader& parameters,
                                                       ReadContext& context) {
  STRATA_ASSIGN_OR_RETURN(ShapeGeometry geometry, ReadGeometry(type, parameters, context));
  if (const Parameter* displacement = parameters.Take("displacement")) {
    context.Warn(displacement->where,
                 "\"displacement\" is not supported; the shape stays as it is");
  }
  STRATA_RETURN_IF_ERROR(parameters.Finish(context.warnings));
  if (IsWithoutFaces(geometry)) {
    WarnWithoutFaces(parameters.where(), context);
    return std::nullopt;
  }
  return geometry;
}

bool IsWithoutFaces(const ShapeGeometry& geometry) {
  const auto* mesh = std::get_if<TriangleMeshShape>(&geometry);
  return mesh && mesh->triangles.empty() && mesh->unread_file.empty();
}

void WarnWithoutFaces(const SourceLocation& where, ReadContext& context) {
  context.Warn(where, "a mesh without faces is left out");
}

absl::Status CheckPlacement(const ShapeGeometry& geometry, const Transform& to_world,
                            const SourceLocation& where) {
  if (!to_world.IsFinite() || !to_world.Inverse()) {
    return ErrorAt(where, "the shape's transform cannot be inverted; check its scale");
  }
  // Of a mesh that has not been read nothing is known.
  if (const auto* mesh = std::get_if<TriangleMeshShape>(&geometry); mesh && mesh->positions.empty())
    return absl::OkStatus();
  const Box bounds = BoundsOf(geometry, to_world);
  if (!FitsFloat(bounds.min) || !FitsFloat(bounds.max)) {
    return ErrorAt(where, "the shape is too large or too far away to be computed with");
  }
  return absl::OkStatus();
}

namespace {

Vec3d Difference(Vec3d a, Vec3d b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

double TriangleArea(Vec3d a, Vec3d b, Vec3d c) {
  const Vec3d u = Difference(b, a), v = Difference(c, a);
  const Vec3d n{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
  return std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z) / 2;
}

double MeshArea(const TriangleMeshShape& mesh, const Transform& to_world) {
  const auto world = [&](uint32_t i) {
    const Vec3f p = mesh.positions[i];
    return to_world.Point({p.x, p.y, p.z});
  };
  double area = 0;
  for (const auto& t : mesh.triangles) area += TriangleArea(world(t[0]), world(t[1]), world(t[2]));
  return area;
}

/// The factor by which a similarity scales lengths; none if the transform is no similarity.
std::optional<double> SimilarityScale(const Transform& t) {
  Vec3d axis[3] = {t.Vector({1, 0, 0}), t.Vector({0, 1, 0}), t.Vector({0, 0, 1})};
  const auto dot = [&](int i, int j) {
    return axis[i].x * axis[j].x + axis[i].y * axis[j].y + axis[i].z * axis[j].z;
  };
  const double square = dot(0, 0), slack = 1e-6 * square;
  for (int i = 0; i < 3; ++i) {
    if (std::fabs(dot(i, i) - square) > slack) return std::nullopt;
    if (std::fabs(dot(i, (i + 1) % 3)) > slack) return std::nullopt;
  }
  return std::sqrt(square);
}

/// Of a quadric in its own space; none for shapes without a closed form.
std::optional<double> OwnArea(const ShapeGeometry& geometry) {
  const auto radians = [](float degrees) { return degrees * std::numbers::pi / 180; };
  if (const auto* s = std::get_if<SphereShape>(&geometry)) {
    return radians(s->phi_max) * s->radius * (s->z_max - s->z_min);
  }
  if (const auto* s = std::get_if<CylinderShape>(&geometry)) {
    return radians(s->phi_max) * s->radius * (s->z_max - s->z_min);
  }
  if (const auto* s = std::get_if<DiskShape>(&geometry)) {
    return radians(s->phi_max) / 2 *
           (double{s->radius} * s->radius - double{s->inner_radius} * s->inner_radius);
  }
  return std::nullopt;
}

}  // namespace

bool IsSimilarity(const Transform& transform) { return SimilarityScale(transform).has_value(); }

absl::StatusOr<double> WorldArea(const ShapeGeometry& geometry, const Transform& to_world,
                                 const SourceLocation& where) {
  if (const auto* mesh = std::get_if<TriangleMeshShape>(&geometry)) {
    return MeshArea(*mesh, to_world);
  }
  const std::optional<double> own = OwnArea(geometry), scale = SimilarityScale(to_world);
  if (!own || !scale) {
    return ErrorAt(where,
                   "\"power\" of an area light wants a triangle mesh, or a sphere, disk or "
                   "cylinder that is not distorted; give \"L\" instead");
  }
  return *own * *scale * *scale;
}

}  // namespace strata
