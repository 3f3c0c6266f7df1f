#pragma once

// Embree 3 and 4 behind the same few names; only geometry's .cpp files and the raw bench see it.

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace strata::embree {

#if RTC_VERSION_MAJOR >= 4

inline void Intersect(RTCScene scene, RTCRayHit* ray_hit) {
  rtcIntersect1(scene, ray_hit, nullptr);
}
inline void Occluded(RTCScene scene, RTCRay* ray) { rtcOccluded1(scene, ray, nullptr); }
inline void Intersect8(const int* valid, RTCScene scene, RTCRayHit8* packet) {
  rtcIntersect8(valid, scene, packet, nullptr);
}
inline void Occluded8(const int* valid, RTCScene scene, RTCRay8* packet) {
  rtcOccluded8(valid, scene, packet, nullptr);
}

#else

// The context is written anew for each ray: four stores, cheaper than looking up a thread's own.
inline void Intersect(RTCScene scene, RTCRayHit* ray_hit) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, ray_hit);
}
inline void Occluded(RTCScene scene, RTCRay* ray) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, ray);
}
inline void Intersect8(const int* valid, RTCScene scene, RTCRayHit8* packet) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect8(valid, scene, &context, packet);
}
inline void Occluded8(const int* valid, RTCScene scene, RTCRay8* packet) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded8(valid, scene, &context, packet);
}

#endif

}  // namespace strata::embree
