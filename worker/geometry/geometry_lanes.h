#pragma once

#include "worker/geometry/geometry.h"
#include "worker/math/lanes.h"

namespace strata {

/// Eight of Ray, Hit and so on, side by side.
struct RayLanes {
  Vec3Lanes origin, direction;
  FloatLanes t_max = SameFloat(std::numeric_limits<float>::infinity());
  FloatLanes time = {};
  IntLanes id = {};

  Ray Get(int lane) const {
    return {origin.Get(lane), direction.Get(lane), t_max[lane], time[lane],
            static_cast<uint32_t>(id[lane])};
  }
};

struct HitLanes {
  FloatLanes t = {}, u = {}, v = {};
  Vec3Lanes local;
  IntLanes geometry = {}, primitive = {}, instance = {};

  Hit Get(int lane) const {
    return {t[lane],
            u[lane],
            v[lane],
            local.Get(lane),
            static_cast<uint32_t>(geometry[lane]),
            static_cast<uint32_t>(primitive[lane]),
            static_cast<uint32_t>(instance[lane])};
  }
};

/// What every path asks of its SurfacePoints.
struct SurfaceLanes {
  Vec3Lanes p, ng, ns;
  FloatLanes offset = {};  ///< OffsetDistance
  IntLanes material = {}, light = {};
  Vec2Lanes uv;  ///< Where they are asked for.

  void Set(int lane, const SurfacePoint& point) {
    p.Set(lane, point.p);
    ng.Set(lane, point.ng);
    ns.Set(lane, point.ns);
    offset[lane] = OffsetDistance(point.p, point.p_error, point.ng);
    material[lane] = point.material;
    light[lane] = point.light;
    uv.x[lane] = point.uv.x;
    uv.y[lane] = point.uv.y;
  }
};

/// Geometry::Intersect for the lanes in `active`; returns those that hit something. Which of two
/// surfaces at one distance is met, and the last bits of a hit, may depend on all rays together.
MaskLanes Intersect(const Geometry& geometry, const RayLanes& rays, MaskLanes active,
                    HitLanes* hits);
/// The lanes in `active` whose segment is blocked.
MaskLanes Occluded(const Geometry& geometry, const RayLanes& rays, MaskLanes active);
/// The points of the lanes in `hit`: triangles of the world itself without alpha masks side by
/// side, all else one by one. `with_uv` asks for texture coordinates.
void FindSurfaces(const Geometry& geometry, const RayLanes& rays, const HitLanes& hits,
                  MaskLanes hit, bool with_uv, SurfaceLanes* surfaces);

inline Vec3Lanes OffsetRayOrigins(Vec3Lanes p, FloatLanes distance, Vec3Lanes ng, Vec3Lanes w) {
  return Fma(ng, Dot(w, ng) < 0 ? -distance : distance, p);
}

}  // namespace strata
