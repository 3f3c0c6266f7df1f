#include "worker/gltf/deform.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "common/text.h"
#include "worker/gltf/accessors.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

absl::Status AddTarget(const GltfDocument& document, int accessor, double weight,
                       const std::string& element, std::vector<Vec3f>* vectors) {
  STRATA_ASSIGN_OR_RETURN(const std::vector<Vec3f> moves, ReadVectors(document, accessor, element));
  if (moves.size() != vectors->size())
    return document.Error(
        element, StrCat("it has ", moves.size(), " elements for ", vectors->size(), " positions"));
  const auto scale = static_cast<float>(weight);
  for (size_t i = 0; i < moves.size(); ++i) (*vectors)[i] += moves[i] * scale;
  return absl::OkStatus();
}

absl::Status ApplyTargets(GltfDocument& document, const tinygltf::Primitive& primitive,
                          const std::vector<double>& weights, const std::string& element,
                          TriangleMeshShape* mesh) {
  for (size_t i = 0; i < std::min(weights.size(), primitive.targets.size()); ++i) {
    if (weights[i] == 0) continue;
    const std::string name = element + "." + ElementName("targets", static_cast<int>(i));
    for (const auto& [attribute, accessor] : primitive.targets[i]) {
      const std::string where = StrCat(name, ".", attribute);
      if (attribute == "POSITION") {
        STRATA_RETURN_IF_ERROR(AddTarget(document, accessor, weights[i], where, &mesh->positions));
      } else if (attribute == "NORMAL" && !mesh->normals.empty()) {
        STRATA_RETURN_IF_ERROR(AddTarget(document, accessor, weights[i], where, &mesh->normals));
      } else if (attribute != "NORMAL" && attribute != "TANGENT") {
        document.Warn(where, "only positions and normals are morphed; it is left out");
      }
    }
  }
  return absl::OkStatus();
}

/// What moves each vertex: joints and weights of all its sets, those of one vertex together.
struct Influences {
  size_t per_vertex = 0;
  std::vector<size_t> joints;
  std::vector<double> weights;  ///< Of sum 1 for each vertex.
};

absl::Status ReadSet(const GltfDocument& document, const tinygltf::Primitive& primitive, int set,
                     size_t vertices, size_t joint_count, const std::string& element,
                     Influences* influences) {
  const std::string joints_name = StrCat("JOINTS_", set), weights_name = StrCat("WEIGHTS_", set);
  const auto read = [&](const std::string& name) -> absl::StatusOr<FloatAttribute> {
    const std::string where = element + ".attributes." + name;
    const auto found = primitive.attributes.find(name);
    if (found == primitive.attributes.end()) return document.Error(where, "it is missing");
    STRATA_ASSIGN_OR_RETURN(FloatAttribute values,
                            ReadFloats(document, found->second, 4, 4, where));
    if (values.Count() != vertices)
      return document.Error(
          where, StrCat("it has ", values.Count(), " elements for ", vertices, " positions"));
    return values;
  };
  STRATA_ASSIGN_OR_RETURN(const FloatAttribute joints, read(joints_name));
  STRATA_ASSIGN_OR_RETURN(const FloatAttribute weights, read(weights_name));
  for (size_t v = 0; v < vertices; ++v) {
    for (size_t k = 0; k < 4; ++k) {
      const float joint = joints.values[4 * v + k], weight = weights.values[4 * v + k];
      const size_t at = influences->per_vertex * v + 4 * static_cast<size_t>(set) + k;
      if (!std::isfinite(weight) || weight < 0)
        return document.Error(element + ".attributes." + weights_name,
                              StrCat("element ", v, " is negative or not finite"));
      // Joints of no weight may be anything.
      if (weight == 0) continue;
      if (!(joint >= 0 && joint < static_cast<float>(joint_count)))
        return document.Error(element + ".attributes." + joints_name,
                              StrCat("element ", v, " names joint ", joint, " of ", joint_count));
      influences->joints[at] = static_cast<size_t>(joint);
      influences->weights[at] = static_cast<double>(weight);
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<Influences> ReadInfluences(const GltfDocument& document,
                                          const tinygltf::Primitive& primitive, size_t vertices,
                                          size_t joint_count, const std::string& element) {
  int sets = 1;
  while (primitive.attributes.contains(StrCat("JOINTS_", sets))) ++sets;
  Influences influences;
  influences.per_vertex = 4 * static_cast<size_t>(sets);
  influences.joints.resize(vertices * influences.per_vertex, 0);
  influences.weights.resize(vertices * influences.per_vertex, 0);
  for (int set = 0; set < sets; ++set)
    STRATA_RETURN_IF_ERROR(
        ReadSet(document, primitive, set, vertices, joint_count, element, &influences));
  // Weights may be rounded to bytes, and a vertex of none follows the first joint.
  for (size_t v = 0; v < vertices; ++v) {
    double* first = &influences.weights[v * influences.per_vertex];
    double sum = 0;
    for (size_t k = 0; k < influences.per_vertex; ++k) sum += first[k];
    if (sum == 0) sum = first[0] = 1;
    for (size_t k = 0; k < influences.per_vertex; ++k) first[k] /= sum;
  }
  return influences;
}

Transform Blend(const Influences& influences, size_t vertex, const std::vector<Transform>& joints) {
  Transform blend;
  blend.m = {};
  for (size_t k = 0; k < influences.per_vertex; ++k) {
    const size_t at = vertex * influences.per_vertex + k;
    const double weight = influences.weights[at];
    if (weight == 0) continue;
    const Transform& joint = joints[influences.joints[at]];
    for (size_t row = 0; row < 4; ++row) {
      for (size_t column = 0; column < 4; ++column)
        blend.m[row][column] += weight * joint.m[row][column];
    }
  }
  return blend;
}

absl::Status ApplySkin(const GltfDocument& document, const tinygltf::Primitive& primitive,
                       const std::vector<Transform>& joints, const std::string& element,
                       TriangleMeshShape* mesh) {
  const size_t vertices = mesh->positions.size();
  STRATA_ASSIGN_OR_RETURN(const Influences influences,
                          ReadInfluences(document, primitive, vertices, joints.size(), element));
  for (size_t v = 0; v < vertices; ++v) {
    const Transform blend = Blend(influences, v, joints);
    mesh->positions[v] = ToFloat(blend.Point(ToDouble(mesh->positions[v])));
    if (!IsFinite(mesh->positions[v]))
      return document.Error(element, StrCat("its skin takes vertex ", v, " beyond all numbers"));
    if (mesh->normals.empty()) continue;
    // A blend that is flat has no inverse; nothing of the vertex is seen then.
    if (const std::optional<Transform> inverse = blend.Inverse())
      mesh->normals[v] =
          ToFloat(Normalize(Transform::Normal(*inverse, ToDouble(mesh->normals[v]))));
    if (!IsFinite(mesh->normals[v])) mesh->normals[v] = {};
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::optional<std::vector<Transform>>> JointsOf(
    GltfDocument& document, int index, const std::vector<std::optional<Transform>>& node_to_world,
    const std::string& element) {
  STRATA_ASSIGN_OR_RETURN(const tinygltf::Skin* skin,
                          document.Find(document.model().skins, index, "skin", element));
  const std::string name = ElementName("skins", index);
  if (skin->joints.empty()) return document.Error(name + ".joints", "it has no joints");
  FloatAttribute matrices;
  if (skin->inverseBindMatrices >= 0) {
    const std::string where = name + ".inverseBindMatrices";
    STRATA_ASSIGN_OR_RETURN(matrices,
                            ReadFloats(document, skin->inverseBindMatrices, 16, 16, where));
    if (matrices.Count() < skin->joints.size())
      return document.Error(
          where, StrCat("it has ", matrices.Count(), " of ", skin->joints.size(), " matrices"));
  }
  std::vector<Transform> joints;
  for (size_t i = 0; i < skin->joints.size(); ++i) {
    const int node = skin->joints[i];
    STRATA_RETURN_IF_ERROR(
        document.Find(document.model().nodes, node, "node", name + ".joints").status());
    const std::optional<Transform>& to_world = node_to_world[static_cast<size_t>(node)];
    if (!to_world) {
      document.Warn(name, StrCat("its joint ", ElementName("nodes", node),
                                 " is not in the scene, so the skin is left out"));
      return std::nullopt;
    }
    Transform joint = *to_world;
    if (matrices.Count() > 0) {
      std::array<double, 16> columns;
      std::copy_n(&matrices.values[16 * i], 16, columns.begin());
      joint = joint * Transform::FromColumns(columns);
    }
    // Rounding may have touched the last row, which says nothing.
    joint.m[3] = {0, 0, 0, 1};
    if (!joint.IsFinite())
      return document.Error(name, StrCat("the matrix of joint ", i, " is not finite"));
    joints.push_back(joint);
  }
  return joints;
}

absl::Status ApplyPose(GltfDocument& document, const tinygltf::Primitive& primitive,
                       const MeshPose& pose, const std::string& element, TriangleMeshShape* mesh) {
  STRATA_RETURN_IF_ERROR(ApplyTargets(document, primitive, pose.weights, element, mesh));
  if (pose.joints.empty()) return absl::OkStatus();
  return ApplySkin(document, primitive, pose.joints, element, mesh);
}

}  // namespace strata
