#pragma once

#include <dlfcn.h>
#include <x86intrin.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>

#include "worker/geometry/embree_compat.h"

// How long a program is inside Embree while it renders: the calls that cast rays are defined here,
// before those of the library, which they time. What Embree calls back (alpha masks, shapes that
// are no triangles) counts as inside. Included by one source of a program.

namespace strata {

namespace embree_clock_detail {

/// Of one thread at a time.
struct alignas(64) Slot {
  std::atomic<uint64_t> ticks{0};
};

}  // namespace embree_clock_detail

/// Thread time inside Embree since the clock was made, of no more than 256 threads; one clock at a
/// time. While there is one, each call costs two readings of the processor's counter, some 1 % of a
/// packet's cast, of which about half counts as inside.
class EmbreeClock {
 public:
  EmbreeClock() {
    for (Slot& slot : slots_) slot.ticks = 0;
    runs_ = true;
  }
  ~EmbreeClock() { runs_ = false; }
  EmbreeClock(const EmbreeClock&) = delete;
  EmbreeClock& operator=(const EmbreeClock&) = delete;

  double Seconds() const {
    uint64_t ticks = 0;
    for (const Slot& slot : slots_) ticks += slot.ticks;
    const double elapsed = std::chrono::duration<double>(Clock::now() - start_).count();
    return static_cast<double>(ticks) * elapsed / static_cast<double>(__rdtsc() - start_ticks_);
  }

  /// Calls `cast`, and counts it if there is a clock.
  template <typename Cast>
  static void Time(Cast cast) {
    if (!runs_.load(std::memory_order_relaxed)) {
      cast();
      return;
    }
    static std::atomic<size_t> threads{0};
    thread_local Slot& slot = slots_[threads++ % slots_.size()];
    const uint64_t start = __rdtsc();
    cast();
    const uint64_t ticks = slot.ticks.load(std::memory_order_relaxed);
    slot.ticks.store(ticks + (__rdtsc() - start), std::memory_order_relaxed);
  }

 private:
  using Clock = std::chrono::steady_clock;
  using Slot = embree_clock_detail::Slot;
  static inline std::array<Slot, 256> slots_;
  static inline std::atomic<bool> runs_{false};

  Clock::time_point start_ = Clock::now();
  uint64_t start_ticks_ = __rdtsc();
};

}  // namespace strata

#define STRATA_TIME_CAST(function, ...)                                   \
  static auto* const original =                                           \
      reinterpret_cast<decltype(&function)>(dlsym(RTLD_NEXT, #function)); \
  strata::EmbreeClock::Time([&] { original(__VA_ARGS__); })

extern "C" {
#if RTC_VERSION_MAJOR >= 4
void rtcIntersect1(RTCScene scene, RTCRayHit* ray, RTCIntersectArguments* arguments) {
  STRATA_TIME_CAST(rtcIntersect1, scene, ray, arguments);
}
void rtcOccluded1(RTCScene scene, RTCRay* ray, RTCOccludedArguments* arguments) {
  STRATA_TIME_CAST(rtcOccluded1, scene, ray, arguments);
}
void rtcIntersect8(const int* valid, RTCScene scene, RTCRayHit8* rays,
                   RTCIntersectArguments* arguments) {
  STRATA_TIME_CAST(rtcIntersect8, valid, scene, rays, arguments);
}
void rtcOccluded8(const int* valid, RTCScene scene, RTCRay8* rays,
                  RTCOccludedArguments* arguments) {
  STRATA_TIME_CAST(rtcOccluded8, valid, scene, rays, arguments);
}
#else
void rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* ray) {
  STRATA_TIME_CAST(rtcIntersect1, scene, context, ray);
}
void rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* ray) {
  STRATA_TIME_CAST(rtcOccluded1, scene, context, ray);
}
void rtcIntersect8(const int* valid, RTCScene scene, RTCIntersectContext* context,
                   RTCRayHit8* rays) {
  STRATA_TIME_CAST(rtcIntersect8, valid, scene, context, rays);
}
void rtcOccluded8(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8* rays) {
  STRATA_TIME_CAST(rtcOccluded8, valid, scene, context, rays);
}
#endif
}
#undef STRATA_TIME_CAST
