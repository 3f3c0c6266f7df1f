#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "worker/geometry/geometry_lanes.h"
#include "worker/light/light_lanes.h"
#include "worker/math/lanes.h"
#include "worker/medium/medium.h"

// What the fast kernel keeps of the paths that it follows at the same time, and their queues.

namespace strata {

/// How many paths there are. More than queues that keep seven each, so that there is always one
/// with eight; all fit into the first cache.
inline constexpr int kPaths = 64;
/// A place that is written for lanes without a path.
inline constexpr int kNoPath = kPaths;

/// What a path carries from stage to stage, in fours for LoadRows and StoreRows.
struct alignas(16) PathState {
  /// In flags. Light sampling could not have found what the ray meets next.
  static constexpr int32_t kSpecular = 1;
  /// A guide sent the ray, and glass alone was met since.
  static constexpr int32_t kToLamp = 2;
  // Of the vertex the ray left, as in LightReceiver.
  static constexpr int32_t kOneSided = 4, kInMedium = 8;

  Vec3f origin;         ///< Of the ray.
  uint32_t ray_id = 0;  ///< Where there are alpha masks.
  Vec3f direction;
  float time = 0;
  Rgb beta;  ///< Throughput so far.
  float eta_scale = 1;
  Rgb radiance;  ///< Found so far, but for shadow rays that wait.
  int32_t flags = 0;
  float bsdf_pdf = 0;  ///< Of the ray's direction.
  int32_t depth = 0, shadow_rays = 0;
  float sure_survival = 0;  ///< PathSettings::sure_survival of its pixel.
  // The vertex: the one the ray left, then the one it came to.
  Vec3f p;
  float offset = 0;  ///< See SurfaceLanes.
  Vec3f ng;
  MaterialId material = 0;
  Vec3f n;             ///< Of shading; of the vertex that was left, that of the LightReceiver.
  float root_sum = 0;  ///< Of the LightReceiver too.
  Vec2f uv;
  MediumId medium = kNoMedium;  ///< That the ray is in.
  int32_t in_medium = 0;        ///< The vertex is a point of it.

  LightReceiver Previous() const {
    return {p, n, (flags & kOneSided) != 0, (flags & kInMedium) != 0, root_sum};
  }
};

/// Some paths, at most eight, that go through a stage side by side: the first lanes.
struct PathBatch {
  static constexpr int32_t kStride = sizeof(PathState) / sizeof(float);

  PathBatch(IntLanes paths, MaskLanes lanes)
      : ids(lanes ? paths : SameInt(kNoPath)),
        mask(lanes),
        path(PlacesOf(ids)),
        state(PlacesOf(ids * kStride)) {}

  IntLanes ids;
  MaskLanes mask;
  LanePlaces path;   ///< ids
  LanePlaces state;  ///< Where their PathStates begin, in floats.
};

/// The states of all paths.
class PathStates {
 public:
  PathState& operator[](int path) { return states_[path]; }
  const PathState& operator[](int path) const { return states_[path]; }

  /// The four values from `offset` (bytes) on of each path of the batch.
  RowLanes Load(size_t offset, const PathBatch& batch) const {
    return LoadRows(Floats(offset), batch.state);
  }
  void Store(size_t offset, const PathBatch& batch, const RowLanes& rows) {
    StoreRows(const_cast<float*>(Floats(offset)), batch.state, rows);
  }

 private:
  const float* Floats(size_t offset) const {
    return reinterpret_cast<const float*>(states_.data()) + offset / sizeof(float);
  }

  std::array<PathState, kPaths + 1> states_;
};

/// Paths that wait for a stage, first come, first served. No path is in two queues.
class PathQueue {
 public:
  int size() const { return end_ - begin_; }
  /// How many have come since the beginning, and how many have gone.
  int64_t pushed() const { return moved_ + end_; }
  int64_t taken() const { return moved_ + begin_; }

  void Push(IntLanes paths, MaskLanes mask) {
    const IntLanes packed = Permute(paths, LanesOfBytes(PackedLanes(mask)));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(&paths_[end_]),
                        reinterpret_cast<__m256i>(packed));
    end_ += __builtin_popcount(Bits(mask));
  }
  PathBatch Take() {
    const IntLanes first = reinterpret_cast<IntLanes>(
        _mm256_loadu_si256(reinterpret_cast<const __m256i*>(&paths_[begin_])));
    const PathBatch batch(first, FirstLanes(size()));
    begin_ += size() < kLanes ? size() : kLanes;
    if (begin_ >= kPaths) {
      std::copy(&paths_[begin_], &paths_[end_], &paths_[0]);
      moved_ += begin_;
      end_ -= begin_;
      begin_ = 0;
    }
    return batch;
  }

 private:
  std::array<int32_t, 2 * kPaths + kLanes> paths_;
  int begin_ = 0, end_ = 0;
  int64_t moved_ = 0;
};

inline Vec3Lanes VectorOf(const RowLanes& rows) { return {rows.v[0], rows.v[1], rows.v[2]}; }
inline RgbLanes ColorOf(const RowLanes& rows) { return {rows.v[0], rows.v[1], rows.v[2]}; }
inline RowLanes RowsOf(const Vec3Lanes& v, FloatLanes w = FloatLanes{}) {
  return {{v.x, v.y, v.z, w}};
}
inline RowLanes RowsOf(const RgbLanes& v, FloatLanes w) { return {{v.r, v.g, v.b, w}}; }

/// Shadow rays that wait until there are eight.
class ShadowQueue {
 public:
  struct Lanes {
    RayLanes rays;
    RgbLanes contribution;  ///< What they bring if nothing is in their way.
    IntLanes medium = {};   ///< Where they start.
    IntLanes path = {};
    MaskLanes last = {};  ///< Nothing but this is awaited of the path.

    /// Calls f for each vector of a and b.
    template <typename F>
    static void ForEach(const Lanes& a, Lanes* b, F f) {
      f(a.rays.origin.x, &b->rays.origin.x);
      f(a.rays.origin.y, &b->rays.origin.y);
      f(a.rays.origin.z, &b->rays.origin.z);
      f(a.rays.direction.x, &b->rays.direction.x);
      f(a.rays.direction.y, &b->rays.direction.y);
      f(a.rays.direction.z, &b->rays.direction.z);
      f(a.rays.t_max, &b->rays.t_max);
      f(a.rays.time, &b->rays.time);
      f(a.rays.id, &b->rays.id);
      f(a.contribution.r, &b->contribution.r);
      f(a.contribution.g, &b->contribution.g);
      f(a.contribution.b, &b->contribution.b);
      f(a.medium, &b->medium);
      f(a.path, &b->path);
      f(a.last, &b->last);
    }
  };

  int size() const { return size_; }
  /// Takes those in `mask`; if that makes eight, `full` are the first and it is true.
  bool Push(const Lanes& lanes, MaskLanes mask, Lanes* full) {
    const uint64_t packed = PackedLanes(mask);
    const int sum = size_ + __builtin_popcount(Bits(mask));
    const IntLanes behind = LanesOfBytes(packed << (8 * size_));
    const MaskLanes before = FirstLanes(size_);
    if (sum < kLanes) {
      Lanes::ForEach(lanes, &waiting_,
                     [&](auto v, auto* to) { *to = before ? *to : Permute(v, behind); });
      size_ = sum;
      return false;
    }
    *full = waiting_;
    const IntLanes rest = LanesOfBytes(size_ == 0 ? 0 : packed >> (8 * (kLanes - size_)));
    Lanes::ForEach(lanes, full, [&](auto v, auto* to) { *to = before ? *to : Permute(v, behind); });
    Lanes::ForEach(lanes, &waiting_, [&](auto v, auto* to) { *to = Permute(v, rest); });
    size_ = sum - kLanes;
    return true;
  }
  /// All of them: the first size().
  const Lanes& Take() {
    size_ = 0;
    return waiting_;
  }

 private:
  Lanes waiting_;
  int size_ = 0;
};

}  // namespace strata
