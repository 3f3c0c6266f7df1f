#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <absl/container/flat_hash_map.h>

#include "worker/geometry/builder.h"
#include "worker/geometry/geometry.h"
#include "worker/geometry/moving_instance.h"
#include "worker/geometry/state.h"

namespace strata {
namespace {

bool Emits(const ShapeDescription& shape) { return shape.emission.has_value(); }

Box BoundsOf(const ShapeGroup& group) {
  Box box;
  for (const TriangleSet* set : {&group.triangles, &group.masked}) {
    for (const TriangleSet::Triangle& triangle : set->triangles) {
      for (const uint32_t vertex : triangle.vertices)
        box.Include(ToDouble(set->vertices[vertex].p));
    }
  }
  for (const CurvedShape& shape : group.curved) {
    box.Include(BoundsOf(shape));
  }
  box.Include(BoundsOf(group.curves));
  return box;
}

/// `motion` is null if the instance does not move.
Box BoundsOf(const Instance& instance, const InstanceMotion* motion, const Box& object) {
  Box box;
  if (object.Empty()) return box;
  const auto include = [&](const Placement::Rows& to_world) {
    for (const Vec3d& corner : object.Corners()) box.Include(Placement::Point(to_world, corner));
  };
  include(instance.placement.to_world);
  if (motion) {
    for (const Placement::Rows& step : motion->steps) include(step);
  }
  return box;
}

/// Frees what growing left over.
void Finish(TriangleSet* set) {
  set->vertices.shrink_to_fit();
  set->second_uvs.shrink_to_fit();
  set->triangles.shrink_to_fit();
  set->shapes.shrink_to_fit();
}

bool HasAlpha(const ShapeGroup& group) {
  return !group.masked.triangles.empty() ||
         std::any_of(group.curves.begin(), group.curves.end(),
                     [](const CurveSet& set) { return !set.masks.empty(); }) ||
         std::any_of(group.curved.begin(), group.curved.end(),
                     [](const CurvedShape& shape) { return shape.alpha.texture != kNoTexture; });
}

void Finish(CurveSets* sets) {
  for (CurveSet& set : *sets) {
    if (!set.normals.empty()) set.normals.emplace_back();
    set.vertices.shrink_to_fit();
    set.normals.shrink_to_fit();
    set.segments.shrink_to_fit();
  }
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

absl::StatusOr<std::unique_ptr<Geometry>> Geometry::Build(const SceneDescription& scene,
                                                          const BuildOptions& options) {
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
    // What moves needs an object of its own.
    uses[instance.object] += instance.to_world_at_end ? 2 : 1;
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
      if (description.to_world_at_end)
        return absl::InvalidArgumentError(
            absl::StrCat(shape.where.ToString(), ": a shape that emits cannot move"));
      STRATA_RETURN_IF_ERROR(builder.Add(shape, description.to_world, true, &state.world));
    }
    if (!group || group->IsEmpty()) continue;
    STRATA_ASSIGN_OR_RETURN(Instance instance, PlaceInstance(description, &state.motions));
    instance.object = group;
    state.instances.push_back(instance);
  }

  const auto finish = [&](ShapeGroup* group) {
    group->state = &state;
    Finish(&group->triangles);
    Finish(&group->masked);
    Finish(&group->curves);
    CreateEmbreeScene(state.device, group);
    geometry->triangle_count_ += group->triangles.triangles.size() + group->masked.triangles.size();
    geometry->has_alpha_ |= HasAlpha(*group);
  };
  finish(&state.world);
  if (options.few_triangles && state.instances.empty() && state.world.HasPlainTrianglesOnly())
    state.few = FewTriangles(state.world.triangles);
  Box bounds = BoundsOf(state.world);
  absl::flat_hash_map<const ShapeGroup*, Box> object_bounds;
  for (const auto& object : state.objects) {
    finish(object.get());
    rtcCommitScene(object->scene);
    object_bounds[object.get()] = BoundsOf(*object);
  }
  for (size_t i = 0; i < state.instances.size(); ++i) {
    const Instance& instance = state.instances[i];
    const InstanceMotion* motion = instance.motion < 0 ? nullptr : &state.motions[instance.motion];
    AttachInstance(state.device, state.world.scene, instance, motion, static_cast<uint32_t>(i));
    bounds.Include(BoundsOf(instance, motion, object_bounds[instance.object]));
  }
  rtcCommitScene(state.world.scene);
  STRATA_RETURN_IF_ERROR(CheckDevice(state.device, "building the scene's hierarchy"));
  if (!bounds.Empty()) geometry->bounds_ = {ToFloat(bounds.min), ToFloat(bounds.max)};
  return geometry;
}

}  // namespace strata
