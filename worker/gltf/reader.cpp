#include "worker/gltf/reader.h"

#include <absl/strings/ascii.h>
#include <absl/strings/match.h>

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "common/text.h"
#include "worker/gltf/cameras.h"
#include "worker/gltf/deform.h"
#include "worker/gltf/document.h"
#include "worker/gltf/lights.h"
#include "worker/gltf/materials.h"
#include "worker/gltf/meshes.h"
#include "worker/gltf/nodes.h"
#include "worker/scene/recentre.h"
#include "worker/scene/scene_options.h"

namespace strata {
namespace {

/// What a file does not say of the picture.
FrameDefaults GltfFrame() {
  FrameDefaults frame;
  frame.spp = 64;
  frame.max_depth = 8;
  frame.filter = DefaultFilter(FilterKind::kGaussian);
  return frame;
}

/// Makes a scene of a document.
class SceneMaker {
 public:
  SceneMaker(GltfDocument& document, const SceneOptions& options)
      : document_(document), options_(options), materials_(document) {}

  absl::Status Make() {
    document_.scene.defaults = GltfFrame();
    document_.scene.materials.push_back(
        DiffuseMaterial{materials_.textures().Constant(Rgb::Gray(0.5f))});
    STRATA_ASSIGN_OR_RETURN(viewpoint_, ParseViewpoint(options_.camera));
    if (!document_.model().animations.empty())
      document_.Warn("animations",
                     "animations are not played: all is rendered in its rest pose, as transforms "
                     "and weights of the nodes say");
    node_to_world_.resize(document_.model().nodes.size());
    STRATA_RETURN_IF_ERROR(
        VisitNodes(document_, [&](const PlacedNode& placed) { return Visit(placed); }));
    STRATA_RETURN_IF_ERROR(PlaceMeshes());
    if (document_.scene.shapes.empty() && document_.scene.instances.empty())
      document_.Warn("scene", "there is no surface in it: nothing is seen but the environment");
    STRATA_RETURN_IF_ERROR(FinishCamera());
    FinishLights();
    return absl::OkStatus();
  }

 private:
  /// Where a mesh stands.
  struct Placement {
    std::string element;
    Transform to_world;
  };
  /// Nodes whose shapes are the same: of one mesh, skin (-1: none) and weights of morph targets.
  struct Model {
    int mesh, skin;
    std::vector<double> weights;
    auto operator<=>(const Model&) const = default;
  };

  absl::Status Visit(const PlacedNode& placed) {
    const tinygltf::Node& node = *placed.node;
    node_to_world_[static_cast<size_t>(placed.index)] = placed.to_world;
    if (node.mesh >= 0) {
      STRATA_ASSIGN_OR_RETURN(
          const tinygltf::Mesh* mesh,
          document_.Find(document_.model().meshes, node.mesh, "mesh", placed.element + ".mesh"));
      STRATA_ASSIGN_OR_RETURN(const std::vector<Transform> instances,
                              InstancesOf(document_, placed));
      std::vector<Placement>& placements =
          placements_[{node.mesh, node.skin, node.weights.empty() ? mesh->weights : node.weights}];
      for (const Transform& instance : instances)
        placements.push_back({placed.element, placed.to_world * instance});
    }
    STRATA_RETURN_IF_ERROR(AddLight(document_, node, placed.to_world, placed.element));
    const bool wanted =
        options_.camera.empty() ? !has_camera_ : IsCameraCalled(document_, node, options_.camera);
    if (node.camera < 0 || viewpoint_ || !wanted || has_camera_) return absl::OkStatus();
    has_camera_ = true;
    return SetCamera(document_, node.camera, placed.to_world, placed.element);
  }

  /// A mesh of one node is shapes of the world, one of several an object with instances.
  absl::Status PlaceMeshes() {
    SceneDescription& scene = document_.scene;
    for (auto& [model, placements] : placements_) {
      MeshPose pose{.weights = model.weights};
      if (model.skin >= 0) {
        STRATA_ASSIGN_OR_RETURN(auto joints, JointsOf(document_, model.skin, node_to_world_,
                                                      placements.front().element + ".skin"));
        // All nodes of a skin show the same, where its joints are.
        if (joints) placements = {{placements.front().element, Transform{}}};
        pose.joints = std::move(joints).value_or(std::vector<Transform>{});
      }
      STRATA_ASSIGN_OR_RETURN(std::vector<ShapeDescription> shapes,
                              MakeShapes(document_, materials_, model.mesh, pose));
      std::vector<const Placement*> sound;
      for (const Placement& placement : placements) {
        if (placement.to_world.Inverse()) {
          sound.push_back(&placement);
        } else {
          // A scale of 0 hides a node, as exporters and animations have it.
          document_.Warn(placement.element, "its transform is singular, so its mesh has no extent");
        }
      }
      if (shapes.empty() || sound.empty()) continue;
      if (sound.size() == 1) {
        for (ShapeDescription& shape : shapes) {
          shape.to_world = sound.front()->to_world;
          scene.shapes.push_back(std::move(shape));
        }
        continue;
      }
      const auto object = static_cast<int32_t>(scene.objects.size());
      scene.objects.push_back({ElementName("meshes", model.mesh), std::move(shapes)});
      for (const Placement* placement : sound)
        scene.instances.push_back({document_.At(placement->element), object, placement->to_world});
    }
    return absl::OkStatus();
  }

  absl::Status FinishCamera() {
    if (has_camera_) return absl::OkStatus();
    if (!options_.camera.empty() && !viewpoint_)
      return document_.Error(
          "cameras", StrCat("there is no camera \"", options_.camera,
                            "\" in the scene; give its name, its index, or x,y,z,x,y,z[,FOV]"));
    if (!viewpoint_) {
      viewpoint_ = FramingViewpoint(BoundsOf(document_.scene));
      const auto numbers = [](Vec3d v) { return StrCat(v.x, ",", v.y, ",", v.z); };
      document_.Warn("cameras", StrCat("there is no camera: one that frames the scene is used, "
                                       "--camera ",
                                       numbers(viewpoint_->eye), ",", numbers(viewpoint_->look)));
    }
    document_.scene.camera = CameraAt(*viewpoint_, {0, 1, 0}, true);
    return absl::OkStatus();
  }

  void FinishLights() {
    if (!options_.environment.empty() || !document_.scene.lights.empty() || materials_.has_lamps())
      return;
    document_.Warn("lights",
                   "there is no light: a constant environment of radiance 1 is used; --env "
                   "IMAGE gives another");
    document_.scene.lights.push_back(
        {document_.At("lights"), ConstantInfiniteLightDescription{{1, 1, 1}}});
  }

  GltfDocument& document_;
  const SceneOptions& options_;
  MaterialMaker materials_;
  std::map<Model, std::vector<Placement>> placements_;
  std::vector<std::optional<Transform>> node_to_world_;  ///< Of the nodes in the scene.
  std::optional<Viewpoint> viewpoint_;
  bool has_camera_ = false;
};

}  // namespace

bool IsGltfPath(std::string_view path) {
  const std::string lower = absl::AsciiStrToLower(ToAbsl(path));
  return absl::EndsWith(lower, ".gltf") || absl::EndsWith(lower, ".glb");
}

absl::StatusOr<SceneFile> ReadGltf(const FileSource& source, const std::string& scene_path,
                                   const SceneOptions& options) {
  STRATA_ASSIGN_OR_RETURN(GltfDocument document, GltfDocument::Load(source, scene_path));
  STRATA_RETURN_IF_ERROR(SceneMaker(document, options).Make());
  return SceneFile{std::move(document.scene),
                   document.warnings.Take(),
                   {document.files.begin(), document.files.end()},
                   {}};
}

}  // namespace strata
