#include <cmath>
#include <limits>

#include "worker/geometry/alpha_mask.h"
#include "worker/geometry/state.h"

namespace strata {
namespace {

/// Ray `i` of a packet of `n`.
SurfaceRay RayOf(RTCRayN* rays, unsigned n, unsigned i) {
  return {{RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i)},
          {RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i)},
          RTCRayN_tfar(rays, n, i)};
}

const ShapeGroup& GroupOf(const void* group) { return *static_cast<const ShapeGroup*>(group); }

/// A point of a group in the world, for solid textures; `instance` is Embree's id.
Vec3f InWorld(const ShapeGroup& group, uint32_t instance, Vec3f p) {
  if (instance == RTC_INVALID_GEOMETRY_ID) return p;
  const Instance& placed = group.state->instances[instance - kFirstInstance];
  return ToFloat(Placement::Point(placed.placement.to_world, ToDouble(p)));
}

/// Drops hits of triangles that are not there.
void FilterMasked(const RTCFilterFunctionNArguments* args) {
  const ShapeGroup& group = GroupOf(args->geometryUserPtr);
  const TextureSet* textures = group.state->textures;
  if (!textures) return;
  const TriangleSet& set = group.masked;
  const unsigned n = args->N;
  for (unsigned i = 0; i < n; ++i) {
    if (!args->valid[i]) continue;
    const Meeting meeting = {RTCRayN_id(args->ray, n, i), kMaskedGeometry,
                             RTCHitN_primID(args->hit, n, i), RTCHitN_instID(args->hit, n, i, 0)};
    const TriangleSet::Triangle& triangle = set.triangles[meeting.primitive];
    const float u = RTCHitN_u(args->hit, n, i), v = RTCHitN_v(args->hit, n, i);
    const auto corner = [&](int k) { return set.vertices[triangle.vertices[k]].p; };
    const Vec3f p0 = corner(0);
    const Vec3f p = p0 + (u * (corner(1) - p0) + v * (corner(2) - p0));
    const Vec2f uv = UvsOf(set, triangle).At(u, v);
    const SurfaceUv uvs = {uv, SecondUvAt(set, triangle, u, v).value_or(uv)};
    if (!IsThere(group.masks[triangle.shape], *textures, uvs, InWorld(group, meeting.instance, p),
                 meeting))
      args->valid[i] = 0;
  }
}

/// Drops hits of curves that are not there.
void FilterCurves(const RTCFilterFunctionNArguments* args) {
  const ShapeGroup& group = GroupOf(args->geometryUserPtr);
  const TextureSet* textures = group.state->textures;
  if (!textures) return;
  const unsigned n = args->N;
  for (unsigned i = 0; i < n; ++i) {
    if (!args->valid[i]) continue;
    const SurfaceRay ray = RayOf(args->ray, n, i);
    Hit hit;
    hit.t = static_cast<float>(ray.t_max);  // In a filter the ray ends at what it meets.
    hit.u = RTCHitN_u(args->hit, n, i);
    hit.v = RTCHitN_v(args->hit, n, i);
    hit.local = {RTCHitN_Ng_x(args->hit, n, i), RTCHitN_Ng_y(args->hit, n, i),
                 RTCHitN_Ng_z(args->hit, n, i)};
    hit.geometry = RTCHitN_geomID(args->hit, n, i);
    hit.primitive = RTCHitN_primID(args->hit, n, i);
    hit.instance = RTCHitN_instID(args->hit, n, i, 0);
    const auto kind = static_cast<CurveKind>(hit.geometry - kFirstCurveGeometry);
    const CurveSet& set = group.curves[static_cast<size_t>(kind)];
    const int32_t mask = set.segments[hit.primitive].mask;
    if (mask < 0) continue;
    const SurfacePoint point = PointOnCurve(group.curves, kind, hit, ray);
    const bool inside = Dot(ToDouble(point.ng), ray.direction) > 0;
    if (!IsThere(set.masks[static_cast<size_t>(mask)], *textures, point.uv,
                 InWorld(group, hit.instance, point.p),
                 {RTCRayN_id(args->ray, n, i), hit.geometry, hit.primitive, hit.instance, inside}))
      args->valid[i] = 0;
  }
}

/// The nearest hit of a curved shape that is there for the ray.
std::optional<SurfaceHit> IntersectVisible(const ShapeGroup& group, uint32_t primitive,
                                           SurfaceRay ray, uint32_t ray_id, uint32_t instance) {
  const CurvedShape& shape = group.curved[primitive];
  while (const std::optional<SurfaceHit> hit = Intersect(shape, ray)) {
    const TextureSet* textures = group.state->textures;
    if (shape.alpha.texture == kNoTexture || !textures) return hit;
    const SurfacePoint point = PointOn(shape, *hit);
    const bool inside = Dot(ToDouble(point.ng), ray.direction) > 0;
    if (IsThere(shape.alpha, *textures, point.uv, InWorld(group, instance, point.p),
                {ray_id, kCurvedGeometry, primitive, instance, inside}))
      return hit;
    ray.t_min = hit->t;
  }
  return std::nullopt;
}

void IntersectCurved(const RTCIntersectFunctionNArguments* args) {
  const unsigned n = args->N;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
  const ShapeGroup& group = GroupOf(args->geometryUserPtr);
  for (unsigned i = 0; i < n; ++i) {
    if (!args->valid[i]) continue;
    const auto hit = IntersectVisible(group, args->primID, RayOf(rays, n, i),
                                      RTCRayN_id(rays, n, i), args->context->instID[0]);
    if (!hit) continue;
    RTCRayN_tfar(rays, n, i) = static_cast<float>(hit->t);
    RTCHitN_u(hits, n, i) = static_cast<float>(hit->u);
    RTCHitN_v(hits, n, i) = static_cast<float>(hit->v);
    // The normal follows from the point; its place carries the point, which t alone blurs.
    RTCHitN_Ng_x(hits, n, i) = static_cast<float>(hit->p.x);
    RTCHitN_Ng_y(hits, n, i) = static_cast<float>(hit->p.y);
    RTCHitN_Ng_z(hits, n, i) = static_cast<float>(hit->p.z);
    RTCHitN_geomID(hits, n, i) = args->geomID;
    RTCHitN_primID(hits, n, i) = args->primID;
    RTCHitN_instID(hits, n, i, 0) = args->context->instID[0];
  }
}

void OccludedCurved(const RTCOccludedFunctionNArguments* args) {
  const unsigned n = args->N;
  const ShapeGroup& group = GroupOf(args->geometryUserPtr);
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] && IntersectVisible(group, args->primID, RayOf(args->ray, n, i),
                                           RTCRayN_id(args->ray, n, i), args->context->instID[0]))
      RTCRayN_tfar(args->ray, n, i) = -std::numeric_limits<float>::infinity();
  }
}

void BoundsOfCurved(const RTCBoundsFunctionArguments* args) {
  const Box box = BoundsOf(GroupOf(args->geometryUserPtr).curved[args->primID]);
  // Traversal is in float: a few units in the last place of the largest coordinate must not miss.
  const auto pad = [](double low, double high) {
    return std::max(std::abs(low), std::abs(high)) * 0x1p-20;
  };
  RTCBounds& bounds = *args->bounds_o;
  bounds.lower_x = static_cast<float>(box.min.x - pad(box.min.x, box.max.x));
  bounds.lower_y = static_cast<float>(box.min.y - pad(box.min.y, box.max.y));
  bounds.lower_z = static_cast<float>(box.min.z - pad(box.min.z, box.max.z));
  bounds.upper_x = static_cast<float>(box.max.x + pad(box.min.x, box.max.x));
  bounds.upper_y = static_cast<float>(box.max.y + pad(box.min.y, box.max.y));
  bounds.upper_z = static_cast<float>(box.max.z + pad(box.min.z, box.max.z));
}

RTCGeometry MakeTriangles(RTCDevice device, const TriangleSet& set) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             set.vertices.data(), offsetof(TriangleSet::Vertex, p),
                             sizeof(TriangleSet::Vertex), set.vertices.size());
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             set.triangles.data(), 0, sizeof(TriangleSet::Triangle),
                             set.triangles.size());
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
  return geometry;
}

void Attach(RTCScene scene, RTCGeometry geometry, uint32_t id) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, id);
  rtcReleaseGeometry(geometry);
}

RTCGeometry MakeMasked(RTCDevice device, ShapeGroup* group) {
  RTCGeometry geometry = MakeTriangles(device, group->masked);
  rtcSetGeometryUserData(geometry, group);
  rtcSetGeometryIntersectFilterFunction(geometry, FilterMasked);
  rtcSetGeometryOccludedFilterFunction(geometry, FilterMasked);
  return geometry;
}

RTCGeometry MakeCurved(RTCDevice device, ShapeGroup* group) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(group->curved.size()));
  rtcSetGeometryUserData(geometry, group);
  rtcSetGeometryBoundsFunction(geometry, BoundsOfCurved, nullptr);
  rtcSetGeometryIntersectFunction(geometry, IntersectCurved);
  rtcSetGeometryOccludedFunction(geometry, OccludedCurved);
  return geometry;
}

RTCGeometry MakeCurves(RTCDevice device, CurveKind kind, ShapeGroup* group) {
  const CurveSet& set = group->curves[static_cast<size_t>(kind)];
  const RTCGeometryType type = kind == CurveKind::kFlat ? RTC_GEOMETRY_TYPE_FLAT_BEZIER_CURVE
                               : kind == CurveKind::kCylinder
                                   ? RTC_GEOMETRY_TYPE_ROUND_BEZIER_CURVE
                                   : RTC_GEOMETRY_TYPE_NORMAL_ORIENTED_BEZIER_CURVE;
  RTCGeometry geometry = rtcNewGeometry(device, type);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                             set.vertices.data(), 0, sizeof(CurveSet::Vertex), set.vertices.size());
  if (kind == CurveKind::kRibbon) {
    // The last normal is padding, since Embree reads sixteen bytes of each.
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3,
                               set.normals.data(), 0, sizeof(Vec3f), set.vertices.size());
  }
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                             set.segments.data(), 0, sizeof(CurveSet::Segment),
                             set.segments.size());
  if (!set.masks.empty()) {
    rtcSetGeometryUserData(geometry, group);
    rtcSetGeometryIntersectFilterFunction(geometry, FilterCurves);
    rtcSetGeometryOccludedFilterFunction(geometry, FilterCurves);
  }
  if (kind == CurveKind::kFlat) rtcSetGeometryTessellationRate(geometry, kFlatCurvePieces);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
  return geometry;
}

}  // namespace

Geometry::State::~State() {
  if (world.scene) rtcReleaseScene(world.scene);
  for (const auto& object : objects) {
    if (object->scene) rtcReleaseScene(object->scene);
  }
  if (device) rtcReleaseDevice(device);
}

void CreateEmbreeScene(RTCDevice device, ShapeGroup* group) {
  group->scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(group->scene, RTC_BUILD_QUALITY_MEDIUM);
  // Embree's robust mode is not asked for: bench_raw_embree saw closest hits 1.5 and occlusion 2
  // times slower with it in the Cornell box. Without it about one ray in ten million slips between
  // two triangles of a closed mesh, far below what sampling can resolve.
  rtcSetSceneFlags(group->scene, RTC_SCENE_FLAG_NONE);
  if (!group->triangles.triangles.empty())
    Attach(group->scene, MakeTriangles(device, group->triangles), kTriangleGeometry);
  if (!group->curved.empty()) Attach(group->scene, MakeCurved(device, group), kCurvedGeometry);
  if (!group->masked.triangles.empty())
    Attach(group->scene, MakeMasked(device, group), kMaskedGeometry);
  for (const CurveKind kind : {CurveKind::kFlat, CurveKind::kCylinder, CurveKind::kRibbon}) {
    const CurveSet& set = group->curves[static_cast<size_t>(kind)];
    if (!set.segments.empty())
      Attach(group->scene, MakeCurves(device, kind, group),
             kFirstCurveGeometry + static_cast<unsigned>(kind));
  }
}

void AttachInstance(RTCDevice device, RTCScene world, const Instance& instance,
                    const InstanceMotion* motion, uint32_t index) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, instance.object->scene);
  const auto set_transform = [&](unsigned step, const Placement::Rows& to_world) {
    float columns[12];
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row)
        columns[3 * column + row] = static_cast<float>(to_world[row][column]);
    }
    rtcSetGeometryTransform(geometry, step, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  };
  if (motion) {
    const unsigned steps = static_cast<unsigned>(motion->steps.size());
    rtcSetGeometryTimeStepCount(geometry, steps);
    for (unsigned i = 0; i < steps; ++i) set_transform(i, motion->steps[i]);
  } else {
    set_transform(0, instance.placement.to_world);
  }
  Attach(world, geometry, kFirstInstance + index);
}

}  // namespace strata
