#include <cmath>
#include <limits>

#include "worker/geometry/state.h"

namespace strata {
namespace {

/// Ray `i` of a packet of `n`.
SurfaceRay RayOf(RTCRayN* rays, unsigned n, unsigned i) {
  return {{RTCRayN_org_x(rays, n, i), RTCRayN_org_y(rays, n, i), RTCRayN_org_z(rays, n, i)},
          {RTCRayN_dir_x(rays, n, i), RTCRayN_dir_y(rays, n, i), RTCRayN_dir_z(rays, n, i)},
          RTCRayN_tfar(rays, n, i)};
}

const CurvedShape& ShapeOf(const void* shapes, unsigned primitive) {
  return static_cast<const CurvedShape*>(shapes)[primitive];
}

void IntersectCurved(const RTCIntersectFunctionNArguments* args) {
  const unsigned n = args->N;
  RTCRayN* rays = RTCRayHitN_RayN(args->rayhit, n);
  RTCHitN* hits = RTCRayHitN_HitN(args->rayhit, n);
  const CurvedShape& shape = ShapeOf(args->geometryUserPtr, args->primID);
  for (unsigned i = 0; i < n; ++i) {
    if (!args->valid[i]) continue;
    const auto hit = Intersect(shape, RayOf(rays, n, i));
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
  const CurvedShape& shape = ShapeOf(args->geometryUserPtr, args->primID);
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] && Intersect(shape, RayOf(args->ray, n, i)))
      RTCRayN_tfar(args->ray, n, i) = -std::numeric_limits<float>::infinity();
  }
}

void BoundsOfCurved(const RTCBoundsFunctionArguments* args) {
  const Box box = BoundsOf(ShapeOf(args->geometryUserPtr, args->primID));
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

void AttachTriangles(RTCDevice device, const TriangleSet& set, RTCScene scene) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  // The last position is padding, since Embree reads sixteen bytes of each.
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                             set.positions.data(), 0, sizeof(Vec3f), set.positions.size() - 1);
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                             set.triangles.data(), 0, sizeof(TriangleSet::Triangle),
                             set.triangles.size());
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, kTriangleGeometry);
  rtcReleaseGeometry(geometry);
}

void AttachCurved(RTCDevice device, std::vector<CurvedShape>& shapes, RTCScene scene) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(shapes.size()));
  rtcSetGeometryUserData(geometry, shapes.data());
  rtcSetGeometryBoundsFunction(geometry, BoundsOfCurved, nullptr);
  rtcSetGeometryIntersectFunction(geometry, IntersectCurved);
  rtcSetGeometryOccludedFunction(geometry, OccludedCurved);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(scene, geometry, kCurvedGeometry);
  rtcReleaseGeometry(geometry);
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
  if (!group->triangles.triangles.empty()) AttachTriangles(device, group->triangles, group->scene);
  if (!group->curved.empty()) AttachCurved(device, group->curved, group->scene);
}

void AttachInstance(RTCDevice device, RTCScene world, const Instance& instance, uint32_t index) {
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
  rtcSetGeometryInstancedScene(geometry, instance.object->scene);
  float columns[12];
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 3; ++row)
      columns[3 * column + row] = static_cast<float>(instance.placement.to_world[row][column]);
  }
  rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(world, geometry, kFirstInstance + index);
  rtcReleaseGeometry(geometry);
}

}  // namespace strata
