#pragma once

#include <atomic>
#include <chrono>
#include <cmath>
#include <random>
#include <thread>
#include <vector>

#include "worker/geometry/geometry.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/geometry/state.h"
#include "worker/math/elementary.h"
#include "worker/math/vec3d.h"
#include "worker/scene/description.h"

// What Embree alone does with the rays of a scene's paths: the yardstick of the renderer's speed.

namespace strata {

/// Rays as a path tracer asks for them, recorded beforehand.
struct RecordedRays {
  std::vector<RTCRay> closest;    ///< Camera rays and bounces, each of its own direction.
  std::vector<RTCRay> occlusion;  ///< Segments between two surface points.
};

/// Millions of rays per second over all threads, one call for each ray.
struct RawEmbreeRates {
  int threads = 1;
  double closest = 0, occlusion = 0;
};

namespace raw_embree_detail {

inline RTCRay ToEmbree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x;
  r.org_y = ray.origin.y;
  r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x;
  r.dir_y = ray.direction.y;
  r.dir_z = ray.direction.z;
  r.tfar = ray.t_max;
  r.mask = ~0u;
  return r;
}

/// Calls `trace` with every ray, or packet of rays, on each of `threads` threads, which start at
/// different places, until `seconds` have passed; returns millions of calls per second.
template <typename Rays, typename Trace>
double Rate(const std::vector<Rays>& rays, int threads, double seconds, Trace trace) {
  using Clock = std::chrono::steady_clock;
  if (rays.empty()) return 0;
  std::atomic<uint64_t> traced{0};
  const Clock::time_point start = Clock::now();
  const auto run = [&](int thread) {
    const size_t block = std::min<size_t>(rays.size(), 4096);
    size_t next = rays.size() / static_cast<size_t>(threads) * static_cast<size_t>(thread);
    uint64_t done = 0;
    while (std::chrono::duration<double>(Clock::now() - start).count() < seconds) {
      for (size_t i = 0; i < block; ++i) {
        trace(rays[next]);
        next = next + 1 == rays.size() ? 0 : next + 1;
      }
      done += block;
    }
    traced += done;
  };
  std::vector<std::thread> others;
  for (int i = 1; i < threads; ++i) others.emplace_back(run, i);
  run(0);
  for (std::thread& other : others) other.join();
  return static_cast<double>(traced) * 1e-6 /
         std::chrono::duration<double>(Clock::now() - start).count();
}

/// Each eight in a row as a packet; what is left over is dropped.
inline std::vector<RayLanes> PacketsOf(const std::vector<RTCRay>& rays) {
  std::vector<RayLanes> packets(rays.size() / kLanes);
  for (size_t i = 0; i < packets.size() * kLanes; ++i) {
    RayLanes& packet = packets[i / kLanes];
    const int lane = static_cast<int>(i % kLanes);
    packet.origin.Set(lane, {rays[i].org_x, rays[i].org_y, rays[i].org_z});
    packet.direction.Set(lane, {rays[i].dir_x, rays[i].dir_y, rays[i].dir_z});
    packet.t_max[lane] = rays[i].tfar;
  }
  return packets;
}

}  // namespace raw_embree_detail

/// Follows `paths` paths of up to `max_bounces` diffuse bounces from random places of the image.
/// Always the same rays for the same scene.
inline RecordedRays RecordRays(const Geometry& geometry, const CameraDescription& camera, int paths,
                               int max_bounces = 5) {
  std::mt19937_64 random(1);
  const auto uniform = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  RecordedRays recorded;
  const Vec3f eye = ToFloat(camera.camera_to_world.Point({}));
  const double extent = Tan(Radians(camera.fov / 2.0));
  Vec3f last = eye;
  for (int path = 0; path < paths; ++path) {
    const Vec3d pixel = {extent * (2 * uniform() - 1), extent * (2 * uniform() - 1), 1};
    Ray ray = {eye, ToFloat(Normalize(camera.camera_to_world.Vector(pixel)))};
    for (int bounce = 0; bounce <= max_bounces; ++bounce) {
      recorded.closest.push_back(raw_embree_detail::ToEmbree(ray));
      Hit hit;
      if (!geometry.Intersect(ray, &hit)) break;
      const SurfacePoint point = geometry.Surface(ray, hit);
      const Vec3f normal = Dot(point.ng, ray.direction) < 0 ? point.ng : -point.ng;
      const Vec3f from = OffsetRayOrigin(point, normal);
      recorded.occlusion.push_back(raw_embree_detail::ToEmbree({from, last - from, 0.999f}));
      last = from;
      const double cos2 = uniform(), cos = std::sqrt(cos2), sin = std::sqrt(1 - cos2);
      const SinCosResult<float> phi = SinCos2Pi(static_cast<float>(uniform()));
      const Frame frame = Frame::FromNormal(normal);
      const Vec3f w = frame.ToWorld({static_cast<float>(sin) * phi.cos,
                                     static_cast<float>(sin) * phi.sin, static_cast<float>(cos)});
      ray = {OffsetRayOrigin(point, w), w};
    }
  }
  return recorded;
}

/// Traces the recorded rays again and again for about `seconds` each, Embree alone.
inline RawEmbreeRates MeasureRawEmbree(const Geometry& geometry, const RecordedRays& rays,
                                       int threads, double seconds) {
  const RTCScene scene = geometry.state().world.scene;
  RawEmbreeRates rates;
  rates.threads = threads;
  rates.closest = raw_embree_detail::Rate(rays.closest, threads, seconds, [&](const RTCRay& ray) {
    RTCRayHit ray_hit;
    ray_hit.ray = ray;
    ray_hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    ray_hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree::Intersect(scene, &ray_hit);
  });
  rates.occlusion =
      raw_embree_detail::Rate(rays.occlusion, threads, seconds, [&](const RTCRay& ray) {
        RTCRay traced = ray;
        embree::Occluded(scene, &traced);
      });
  return rates;
}

/// The same rays cast in packets of eight as the fast kernel casts them, which in small scenes is
/// without Embree.
inline RawEmbreeRates MeasurePackets(const Geometry& geometry, const RecordedRays& rays,
                                     int threads, double seconds) {
  using namespace raw_embree_detail;
  RawEmbreeRates rates;
  rates.threads = threads;
  rates.closest =
      kLanes * Rate(PacketsOf(rays.closest), threads, seconds, [&](const RayLanes& packet) {
        HitLanes hits;
        Intersect(geometry, packet, SameInt(-1), &hits);
      });
  rates.occlusion =
      kLanes * Rate(PacketsOf(rays.occlusion), threads, seconds,
                    [&](const RayLanes& packet) { Occluded(geometry, packet, SameInt(-1)); });
  return rates;
}

}  // namespace strata
