#include "worker/gltf/nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/text.h"
#include "worker/gltf/accessors.h"
#include "worker/gltf/extension.h"

namespace strata {
namespace {

/// Of a quaternion x, y, z, w of any length but 0.
std::optional<Transform> Rotation(double x, double y, double z, double w) {
  const double length2 = x * x + y * y + z * z + w * w;
  if (!(length2 > 0) || !std::isfinite(length2)) return std::nullopt;
  const double s = 2 / length2;
  Transform t;
  t.m = {{{1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w), 0},
          {s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w), 0},
          {s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y), 0},
          {0, 0, 0, 1}}};
  return t;
}

absl::StatusOr<Transform> LocalTransform(const GltfDocument& document, const tinygltf::Node& node,
                                         const std::string& element) {
  const auto wrong = [&](const char* property, const char* what) {
    return document.Error(StrCat(element, ".", property), what);
  };
  Transform local;
  if (!node.matrix.empty()) {
    if (node.matrix.size() != 16) return wrong("matrix", "it must have 16 numbers");
    std::array<double, 16> columns;
    std::copy(node.matrix.begin(), node.matrix.end(), columns.begin());
    local = Transform::FromColumns(columns);
    const auto& last = local.m[3];
    constexpr double kRounding = 1e-5;
    if (!(std::fabs(last[0]) + std::fabs(last[1]) + std::fabs(last[2]) + std::fabs(last[3] - 1) <
          kRounding))
      return wrong("matrix", "its last row must be 0, 0, 0, 1");
    local.m[3] = {0, 0, 0, 1};
  } else {
    if (!node.translation.empty()) {
      if (node.translation.size() != 3) return wrong("translation", "it must have 3 numbers");
      local = Transform::Translate(node.translation[0], node.translation[1], node.translation[2]);
    }
    if (!node.rotation.empty()) {
      if (node.rotation.size() != 4) return wrong("rotation", "it must have 4 numbers");
      const std::optional<Transform> rotation =
          Rotation(node.rotation[0], node.rotation[1], node.rotation[2], node.rotation[3]);
      if (!rotation) return wrong("rotation", "the quaternion has no direction");
      local = local * *rotation;
    }
    if (!node.scale.empty()) {
      if (node.scale.size() != 3) return wrong("scale", "it must have 3 numbers");
      local = local * Transform::Scale(node.scale[0], node.scale[1], node.scale[2]);
    }
  }
  if (!local.IsFinite()) return document.Error(element, "its transform is not finite");
  return local;
}

/// The roots of the default scene; of all there is where the file has no scene.
absl::StatusOr<std::vector<int>> Roots(GltfDocument& document) {
  const tinygltf::Model& model = document.model();
  if (!model.scenes.empty()) {
    const int index = std::max(model.defaultScene, 0);
    STRATA_ASSIGN_OR_RETURN(const tinygltf::Scene* scene,
                            document.Find(model.scenes, index, "scene", "scene"));
    if (model.scenes.size() > 1)
      document.Warn("scenes",
                    StrCat("of ", model.scenes.size(), " scenes number ", index, " is rendered"));
    return scene->nodes;
  }
  std::vector<bool> is_child(model.nodes.size(), false);
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) {
      if (child >= 0 && static_cast<size_t>(child) < is_child.size()) is_child[child] = true;
    }
  }
  std::vector<int> roots;
  for (size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

}  // namespace

absl::Status VisitNodes(GltfDocument& document,
                        const std::function<absl::Status(const PlacedNode&)>& visit) {
  const tinygltf::Model& model = document.model();
  STRATA_ASSIGN_OR_RETURN(const std::vector<int> roots, Roots(document));
  /// To be visited, the next one last.
  struct Waiting {
    int node;
    Transform parent;
    std::string named_by;
  };
  std::vector<Waiting> waiting;
  const auto wait = [&](const std::vector<int>& nodes, const Transform& parent,
                        const std::string& named_by) {
    for (size_t i = nodes.size(); i-- > 0;) waiting.push_back({nodes[i], parent, named_by});
  };
  wait(roots, {}, "scene");
  std::vector<bool> seen(model.nodes.size(), false);
  while (!waiting.empty()) {
    const Waiting next = std::move(waiting.back());
    waiting.pop_back();
    STRATA_ASSIGN_OR_RETURN(const tinygltf::Node* node,
                            document.Find(model.nodes, next.node, "node", next.named_by));
    const std::string element = ElementName("nodes", next.node);
    if (seen[next.node])
      return document.Error(element,
                            "it is reached twice; a node has one parent and is not its own");
    seen[next.node] = true;
    STRATA_ASSIGN_OR_RETURN(const Transform local, LocalTransform(document, *node, element));
    const PlacedNode placed = {node, next.node, element, next.parent * local};
    if (!placed.to_world.IsFinite())
      return document.Error(element, "with the nodes above it its transform is not finite");
    STRATA_RETURN_IF_ERROR(visit(placed));
    wait(node->children, placed.to_world, element + ".children");
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Transform>> InstancesOf(const GltfDocument& document,
                                                   const PlacedNode& placed) {
  const GltfExtension extension(document, placed.node->extensions, "EXT_mesh_gpu_instancing",
                                placed.element);
  if (!extension.present()) return std::vector<Transform>{Transform{}};
  const std::string element = extension.element() + ".attributes";
  if (!extension.Has("attributes") || !extension.Get("attributes").IsObject())
    return document.Error(element, "it is missing");
  const GltfExtension attributes(document, extension.Get("attributes"), element);
  std::optional<size_t> count;
  const auto read = [&](const char* name, int components) -> absl::StatusOr<FloatAttribute> {
    FloatAttribute values;
    STRATA_ASSIGN_OR_RETURN(const int accessor, attributes.Index(name));
    if (accessor < 0) return values;
    STRATA_ASSIGN_OR_RETURN(
        values, ReadFloats(document, accessor, components, components, StrCat(element, ".", name)));
    if (count && *count != values.Count())
      return document.Error(element, "its attributes differ in their counts");
    count = values.Count();
    return values;
  };
  STRATA_ASSIGN_OR_RETURN(const FloatAttribute translations, read("TRANSLATION", 3));
  STRATA_ASSIGN_OR_RETURN(const FloatAttribute rotations, read("ROTATION", 4));
  STRATA_ASSIGN_OR_RETURN(const FloatAttribute scales, read("SCALE", 3));
  std::vector<Transform> instances(count.value_or(0));
  for (size_t i = 0; i < instances.size(); ++i) {
    Transform& t = instances[i];
    if (translations.Count() > 0) {
      const float* v = &translations.values[3 * i];
      t = Transform::Translate(v[0], v[1], v[2]);
    }
    if (rotations.Count() > 0) {
      const float* q = &rotations.values[4 * i];
      const std::optional<Transform> rotation = Rotation(q[0], q[1], q[2], q[3]);
      if (!rotation) return document.Error(element, StrCat("rotation ", i, " has no direction"));
      t = t * *rotation;
    }
    if (scales.Count() > 0) {
      const float* s = &scales.values[3 * i];
      t = t * Transform::Scale(s[0], s[1], s[2]);
    }
    if (!t.IsFinite()) return document.Error(element, StrCat("instance ", i, " is not finite"));
  }
  return instances;
}

}  // namespace strata
