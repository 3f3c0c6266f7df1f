#include "worker/scene/recentre.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "worker/math/box.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

Box BoundsOf(const std::vector<Vec3f>& positions) {
  Box box;
  for (const Vec3f& p : positions) box.Include(Vec3d{p.x, p.y, p.z});
  return box;
}
Box BoundsOf(const TriangleMeshShape& s) { return BoundsOf(s.positions); }
Box BoundsOf(const BilinearPatchShape& s) { return BoundsOf(s.positions); }
Box BoundsOf(const SphereShape& s) {
  return {{-s.radius, -s.radius, s.z_min}, {s.radius, s.radius, s.z_max}};
}
Box BoundsOf(const DiskShape& s) {
  return {{-s.radius, -s.radius, s.height}, {s.radius, s.radius, s.height}};
}
Box BoundsOf(const CylinderShape& s) {
  return {{-s.radius, -s.radius, s.z_min}, {s.radius, s.radius, s.z_max}};
}
Box BoundsOf(const CurveShape& s) {
  Box box = BoundsOf(s.positions);
  if (box.Empty() || s.radii.empty()) return box;
  const double radius = *std::max_element(s.radii.begin(), s.radii.end());
  box.Include(box.min - Vec3d{radius, radius, radius});
  box.Include(box.max + Vec3d{radius, radius, radius});
  return box;
}

/// A box around `box` taken through `to`.
Box Placed(const Box& box, const Transform& to) {
  Box placed;
  if (box.Empty()) return placed;
  for (const Vec3d& corner : box.Corners()) placed.Include(to.Point(corner));
  return placed;
}

Box BoundsOf(const std::vector<ShapeDescription>& shapes) {
  Box box;
  for (const ShapeDescription& shape : shapes)
    box.Include(BoundsOf(shape.geometry, shape.to_world));
  return box;
}

/// The origin that Recentre moves to; the old one for a scene without shapes or beyond all numbers.
Vec3d OriginOf(const SceneDescription& scene) {
  const Box box = BoundsOf(scene);
  if (box.Empty()) return {};
  const Vec3d eye = scene.camera.camera_to_world.Point({0, 0, 0});
  const double extent =
      std::max({box.max.x - box.min.x, box.max.y - box.min.y, box.max.z - box.min.z});
  const double step = extent > 0 ? std::ldexp(1.0, std::ilogb(extent) - 20) : 0;
  const auto nearest = [&](double x, double min, double max) {
    const double inside = std::clamp(x, min, max);
    return step > 0 ? std::floor(inside / step + 0.5) * step : inside;
  };
  const Vec3d origin = {nearest(eye.x, box.min.x, box.max.x), nearest(eye.y, box.min.y, box.max.y),
                        nearest(eye.z, box.min.z, box.max.z)};
  const bool finite = std::isfinite(origin.x) && std::isfinite(origin.y) && std::isfinite(origin.z);
  return finite ? origin : Vec3d{};
}

}  // namespace

Box BoundsOf(const SceneDescription& scene) {
  Box box = BoundsOf(scene.shapes);
  std::vector<Box> objects;
  for (const ObjectDescription& object : scene.objects) objects.push_back(BoundsOf(object.shapes));
  for (const InstanceDescription& instance : scene.instances) {
    const size_t object = static_cast<size_t>(instance.object);
    if (object >= objects.size()) continue;
    box.Include(Placed(objects[object], instance.to_world));
    if (instance.to_world_at_end) box.Include(Placed(objects[object], *instance.to_world_at_end));
  }
  return box;
}

Box BoundsOf(const ShapeGeometry& shape, const Transform& to) {
  return Placed(std::visit([](const auto& s) { return BoundsOf(s); }, shape), to);
}

Vec3d Recentre(SceneDescription& scene) {
  const Vec3d origin = OriginOf(scene);
  const Transform to_new = Transform::Translate(-origin.x, -origin.y, -origin.z);
  const Transform to_file = Transform::Translate(origin.x, origin.y, origin.z);
  const auto move = [&](Transform& to_world, std::optional<Transform>& at_end) {
    to_world = to_new * to_world;
    if (at_end) at_end = to_new * *at_end;
  };
  move(scene.camera.camera_to_world, scene.camera.camera_to_world_at_end);
  for (ShapeDescription& shape : scene.shapes) shape.to_world = to_new * shape.to_world;
  for (InstanceDescription& instance : scene.instances)
    move(instance.to_world, instance.to_world_at_end);
  for (LightDescription& light : scene.lights) {
    if (auto* point = std::get_if<PointLightDescription>(&light.light))
      point->position = to_new.Point(point->position);
    if (auto* spot = std::get_if<SpotLightDescription>(&light.light))
      spot->position = to_new.Point(spot->position);
    if (auto* projection = std::get_if<ProjectionLightDescription>(&light.light))
      projection->to_world = to_new * projection->to_world;
    if (auto* lamp = std::get_if<GoniometricLightDescription>(&light.light))
      lamp->to_world = to_new * lamp->to_world;
    if (auto* sky = std::get_if<ImageInfiniteLightDescription>(&light.light); sky && sky->portal) {
      for (Vec3d& corner : *sky->portal) corner = to_new.Point(corner);
    }
  }
  for (TextureDescription& texture : scene.textures) {
    if (auto* checkerboard = std::get_if<CheckerboardTexture>(&texture))
      checkerboard->world_to_texture = checkerboard->world_to_texture * to_file;
    if (auto* noise = std::get_if<NoiseTexture>(&texture))
      noise->world_to_texture = noise->world_to_texture * to_file;
  }
  return origin;
}

}  // namespace strata
