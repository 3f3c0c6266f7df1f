#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <absl/container/flat_hash_map.h>

#include "worker/geometry/builder.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/state.h"

namespace strata {
namespace {

bool Emits(const ShapeDescription& shape) { return shape.emission.has_value(); }

/// Embree inverts an instance's matrix in float, by cofactors over the determinant, and takes each
/// ray's origin through the result. Bounds the error of that, element by element (PBRT 6.8.1), and
/// maps it back to the world.
void SetOriginError(Instance* instance) {
  const auto& m = instance->placement.to_world;
  const auto& inverse = instance->placement.to_object;
  double determinant_terms = 0;
  double cofactor_terms[3][3];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const int r1 = (column + 1) % 3, r2 = (column + 2) % 3;
      const int c1 = (row + 1) % 3, c2 = (row + 2) % 3;
      cofactor_terms[row][column] =
          std::abs(m[r1][c1] * m[r2][c2]) + std::abs(m[r1][c2] * m[r2][c1]);
    }
  }
  for (int i = 0; i < 3; ++i) determinant_terms += std::abs(m[i][0]) * cofactor_terms[0][i];
  const double determinant = std::abs(instance->placement.determinant);
  double error[3][3];
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      error[row][column] =
          Gamma(8) * (cofactor_terms[row][column] / determinant +
                      std::abs(inverse[row][column]) * (1 + determinant_terms / determinant));
    }
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      instance->origin_error[row][column] = 0;
      for (int k = 0; k < 3; ++k)
        instance->origin_error[row][column] += std::abs(m[row][k]) * error[k][column];
    }
  }
}

/// The transform as Embree will hold it.
Transform RoundedToFloat(Transform transform) {
  for (auto& row : transform.m) {
    for (double& element : row) element = static_cast<float>(element);
  }
  return transform;
}

Box BoundsOf(const ShapeGroup& group) {
  Box box;
  for (const TriangleSet* set : {&group.triangles, &group.masked}) {
    for (const TriangleSet::Triangle& triangle : set->triangles) {
      for (const uint32_t vertex : triangle.vertices) box.Include(ToDouble(set->positions[vertex]));
    }
  }
  for (const CurvedShape& shape : group.curved) {
    box.Include(BoundsOf(shape));
  }
  return box;
}

Box BoundsOf(const Instance& instance, const Box& object) {
  Box box;
  if (object.Empty()) return box;
  for (const Vec3d& corner : object.Corners())
    box.Include(Placement::Point(instance.placement.to_world, corner));
  return box;
}

/// Frees what growing left over and pads the positions for Embree.
void Finish(TriangleSet* set) {
  set->positions.emplace_back();
  set->positions.shrink_to_fit();
  set->normals.shrink_to_fit();
  set->uvs.shrink_to_fit();
  set->triangles.shrink_to_fit();
  set->shapes.shrink_to_fit();
}

bool HasAlpha(const ShapeGroup& group) {
  return !group.masked.triangles.empty() ||
         std::any_of(group.curved.begin(), group.curved.end(),
                     [](const CurvedShape& shape) { return shape.alpha.texture != kNoTexture; });
}

absl::Status CheckDevice(RTCDevice device, const std::string& doing) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return absl::OkStatus();
  const std::string text =
      absl::StrCat("Embree failed (error ", static_cast<int>(error), ") while ", doing);
  return error == RTC_ERROR_OUT_OF_MEMORY ? absl::ResourceExhaustedError(text)
                                          : absl::InternalError(text);
}

}  // namespace

absl::StatusOr<std::unique_ptr<Geometry>> Geometry::Build(const SceneDescription& scene) {
  std::unique_ptr<Geometry> geometry(new Geometry);
  geometry->state_ = std::make_unique<State>();
  State& state = *geometry->state_;
  // One instruction set for all machines, so that hits have equal bits.
  state.device = rtcNewDevice("isa=avx2");
  if (!state.device)
    return absl::InternalError("Embree gives no device: this processor must have AVX2");

  ShapeBuilder builder(scene, &geometry->emitters_);
  for (const ShapeDescription& shape : scene.shapes)
    STRATA_RETURN_IF_ERROR(builder.Add(shape, Transform{}, true, &state.world));

  // An object that is placed once becomes part of the world, which traces faster. Others are shared
  // by their instances, but for their emissive shapes, since lights are sampled in the world.
  std::vector<int> uses(scene.objects.size(), 0);
  for (const InstanceDescription& instance : scene.instances) {
    if (instance.object < 0 || static_cast<size_t>(instance.object) >= uses.size())
      return absl::InvalidArgumentError(
          absl::StrCat(instance.where.ToString(), ": the instance names no object"));
    ++uses[instance.object];
  }
  std::vector<const ShapeGroup*> groups(scene.objects.size(), nullptr);
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    if (uses[i] < 2) continue;
    auto group = std::make_unique<ShapeGroup>();
    for (const ShapeDescription& shape : scene.objects[i].shapes) {
      if (!Emits(shape))
        STRATA_RETURN_IF_ERROR(builder.Add(shape, Transform{}, false, group.get()));
    }
    groups[i] = group.get();
    state.objects.push_back(std::move(group));
  }
  for (const InstanceDescription& description : scene.instances) {
    const ShapeGroup* group = groups[description.object];
    for (const ShapeDescription& shape : scene.objects[description.object].shapes) {
      if (group && !Emits(shape)) continue;
      STRATA_RETURN_IF_ERROR(builder.Add(shape, description.to_world, true, &state.world));
    }
    if (!group || group->IsEmpty()) continue;
    const std::optional<Placement> placement =
        Placement::From(RoundedToFloat(description.to_world));
    if (!placement)
      return absl::InvalidArgumentError(absl::StrCat(
          description.where.ToString(), ": the instance's transform is singular or not affine"));
    Instance instance;
    instance.object = group;
    instance.placement = *placement;
    SetOriginError(&instance);
    state.instances.push_back(instance);
  }

  const auto finish = [&](ShapeGroup* group) {
    group->state = &state;
    Finish(&group->triangles);
    Finish(&group->masked);
    CreateEmbreeScene(state.device, group);
    geometry->triangle_count_ += group->triangles.triangles.size() + group->masked.triangles.size();
    geometry->has_alpha_ |= HasAlpha(*group);
  };
  finish(&state.world);
  Box bounds = BoundsOf(state.world);
  absl::flat_hash_map<const ShapeGroup*, Box> object_bounds;
  for (const auto& object : state.objects) {
    finish(object.get());
    rtcCommitScene(object->scene);
    object_bounds[object.get()] = BoundsOf(*object);
  }
  for (size_t i = 0; i < state.instances.size(); ++i) {
    const Instance& instance = state.instances[i];
    AttachInstance(state.device, state.world.scene, instance, static_cast<uint32_t>(i));
    bounds.Include(BoundsOf(instance, object_bounds[instance.object]));
  }
  rtcCommitScene(state.world.scene);
  STRATA_RETURN_IF_ERROR(CheckDevice(state.device, "building the scene's hierarchy"));
  if (!bounds.Empty()) geometry->bounds_ = {ToFloat(bounds.min), ToFloat(bounds.max)};
  return geometry;
}

}  // namespace strata
