#include "worker/geometry/geometry.h"

#include <limits>

#include "worker/geometry/moving_instance.h"
#include "worker/geometry/state.h"

namespace strata {
namespace {

void SetRay(const Ray& from, RTCRay* to) {
  to->org_x = from.origin.x;
  to->org_y = from.origin.y;
  to->org_z = from.origin.z;
  // Embree takes a hit at tnear itself, and a point of the plane y = 0 has no error to be offset
  // by.
  to->tnear = std::numeric_limits<float>::min();
  to->dir_x = from.direction.x;
  to->dir_y = from.direction.y;
  to->dir_z = from.direction.z;
  to->time = from.time;
  to->tfar = from.t_max;
  to->mask = ~0u;
  to->id = from.id;
  to->flags = 0;
}

/// `to_group` leads from the ray's space to the group's; null: they are the same.
SurfacePoint PointIn(const ShapeGroup& group, const Ray& ray, const Hit& hit,
                     const Placement::Rows* to_group) {
  if (hit.geometry == kTriangleGeometry)
    return PointOnTriangle(group.triangles, hit.primitive, hit.u, hit.v);
  if (hit.geometry == kMaskedGeometry)
    return PointOnTriangle(group.masked, hit.primitive, hit.u, hit.v);
  if (hit.geometry >= kFirstCurveGeometry) {
    SurfaceRay local = {ToDouble(ray.origin), ToDouble(ray.direction)};
    if (to_group) {
      local.origin = Placement::Point(*to_group, local.origin);
      local.direction = Placement::Vector(*to_group, local.direction);
    }
    const auto kind = static_cast<CurveKind>(hit.geometry - kFirstCurveGeometry);
    return PointOnCurve(group.curves, kind, hit, local);
  }
  return PointOn(group.curved[hit.primitive], {hit.t, ToDouble(hit.local), hit.u, hit.v});
}

SurfaceDerivatives DerivativesIn(const ShapeGroup& group, const Hit& hit) {
  if (hit.geometry == kTriangleGeometry)
    return DerivativesOnTriangle(group.triangles, hit.primitive, hit.u, hit.v);
  if (hit.geometry == kMaskedGeometry)
    return DerivativesOnTriangle(group.masked, hit.primitive, hit.u, hit.v);
  if (hit.geometry >= kFirstCurveGeometry) return {};  // They have no bumps.
  return DerivativesOn(group.curved[hit.primitive], {hit.t, ToDouble(hit.local), hit.u, hit.v});
}

/// A point of an object in the world. Its error: that in the object's space, one rounding, and what
/// the intersector may err by when it takes a ray that leaves the point back into that space.
SurfacePoint ToWorld(const Instance& instance, SurfacePoint point) {
  const Placement& placement = instance.placement;
  const auto& m = placement.to_world;
  const Vec3f error = point.p_error;
  point.p = ToFloat(Placement::Point(m, ToDouble(point.p)));
  const double reach[3] = {std::abs(point.p.x) + std::abs(m[0][3]),
                           std::abs(point.p.y) + std::abs(m[1][3]),
                           std::abs(point.p.z) + std::abs(m[2][3])};
  const auto world_error = [&](int row, float p) {
    const auto& linear = m[row];
    const auto& origin = instance.origin_error[row];
    return Gamma(2) * std::abs(p) +
           static_cast<float>(std::abs(linear[0]) * error.x + std::abs(linear[1]) * error.y +
                              std::abs(linear[2]) * error.z + origin[0] * reach[0] +
                              origin[1] * reach[1] + origin[2] * reach[2]);
  };
  point.p_error = {world_error(0, point.p.x), world_error(1, point.p.y), world_error(2, point.p.z)};
  point.ng = ToFloat(Normalize(placement.NormalToWorld(ToDouble(point.ng))));
  point.ns = ToFloat(Normalize(placement.NormalToWorld(ToDouble(point.ns))));
  if (Dot(point.ns, point.ng) < 0) point.ns = -point.ns;
  point.dpdu = ToFloat(Placement::Vector(m, ToDouble(point.dpdu)));
  return point;
}

}  // namespace

Geometry::Geometry() = default;
Geometry::~Geometry() = default;

bool Geometry::Intersect(const Ray& ray, Hit* hit) const {
  RTCRayHit ray_hit;
  SetRay(ray, &ray_hit.ray);
  ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  embree::Intersect(state_->world.scene, &ray_hit);
  if (ray_hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;
  hit->t = ray_hit.ray.tfar;
  hit->u = ray_hit.hit.u;
  hit->v = ray_hit.hit.v;
  hit->local = {ray_hit.hit.Ng_x, ray_hit.hit.Ng_y, ray_hit.hit.Ng_z};
  hit->geometry = ray_hit.hit.geomID;
  hit->primitive = ray_hit.hit.primID;
  hit->instance = ray_hit.hit.instID[0];
  return true;
}

bool Geometry::Occluded(const Ray& ray) const {
  RTCRay embree_ray;
  SetRay(ray, &embree_ray);
  embree::Occluded(state_->world.scene, &embree_ray);
  return embree_ray.tfar < 0;
}

SurfacePoint Geometry::Surface(const Ray& ray, const Hit& hit) const {
  if (hit.instance == RTC_INVALID_GEOMETRY_ID) return PointIn(state_->world, ray, hit, nullptr);
  const Instance& instance = state_->instances[hit.instance - kFirstInstance];
  const auto in_world = [&](const Instance& placed) {
    return ToWorld(placed, PointIn(*placed.object, ray, hit, &placed.placement.to_object));
  };
  if (instance.motion < 0) return in_world(instance);
  const MovedInstance moved(instance, state_->motions[instance.motion], ray.time);
  SurfacePoint world = in_world(moved.instance);
  world.p_error += moved.translation_error;
  return world;
}

SurfaceDerivatives Geometry::Derivatives(const Ray& ray, const Hit& hit) const {
  if (hit.instance == RTC_INVALID_GEOMETRY_ID) return DerivativesIn(state_->world, hit);
  const Instance& instance = state_->instances[hit.instance - kFirstInstance];
  const auto in_world = [&](const Placement& placement) -> SurfaceDerivatives {
    const SurfacePoint point = PointIn(*instance.object, ray, hit, &placement.to_object);
    const SurfaceDerivatives local = DerivativesIn(*instance.object, hit);
    // The side that ToWorld chooses for the normal.
    const bool flipped = Dot(placement.NormalToWorld(ToDouble(point.ns)),
                             placement.NormalToWorld(ToDouble(point.ng))) < 0;
    const NormalDerivatives normals(placement, ToDouble(point.ns), flipped);
    return {ToFloat(Placement::Vector(placement.to_world, ToDouble(local.dpdu))),
            ToFloat(Placement::Vector(placement.to_world, ToDouble(local.dpdv))),
            normals(ToDouble(local.dndu)), normals(ToDouble(local.dndv))};
  };
  if (instance.motion < 0) return in_world(instance.placement);
  const MovedInstance moved(instance, state_->motions[instance.motion], ray.time);
  return in_world(moved.instance.placement);
}

void Geometry::SetTextures(const TextureSet& textures) { state_->textures = &textures; }

bool Geometry::moves() const { return !state_->motions.empty(); }

EmitterPoint Geometry::SampleEmitter(const OtherEmitter& emitter, Vec2f u) const {
  return SampleArea(state_->world.curved[emitter.shape], u);
}

float Geometry::EmitterPdfArea(const OtherEmitter& emitter, Vec3f p) const {
  return PdfArea(state_->world.curved[emitter.shape], p);
}

Vec2f Geometry::EmitterUv(uint32_t shape, Vec3f p) const {
  return UvAt(state_->world.curved[shape], p);
}

}  // namespace strata
