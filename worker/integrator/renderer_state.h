#pragma once

#include <cstdint>
#include <memory>

#include "worker/integrator/camera.h"
#include "worker/integrator/path.h"
#include "worker/integrator/render.h"
#include "worker/integrator/roulette_map.h"
#include "worker/sampling/filter.h"
#include "worker/sampling/pattern_sampler.h"
#include "worker/sampling/sampler.h"
#include "worker/sampling/warp.h"
#include "worker/sampling/warp_lanes.h"

namespace strata {

class DefectList;

/// Calls the function template `f` for the sampler that kernels of `kind` are compiled with.
template <typename F>
auto WithSampler(SamplerKind kind, F f) {
  if (kind == SamplerKind::kSobol) return f.template operator()<SobolSampler>();
  if (kind == SamplerKind::kIndependent) return f.template operator()<IndependentSampler>();
  return f.template operator()<PatternSampler>();
}

/// All that decides a job's samples.
struct Renderer::State {
  std::shared_ptr<const Scene> scene;
  JobSpec spec;
  PixelLayout layout;
  Camera camera;
  FilterSampler filter;
  PathSettings settings;
  RouletteMap roulette;
  bool moves = false;  ///< Something does: samples have times of their own.
  PixelRect may_hit;   ///< Camera rays of other pixels meet nothing.

  bool SeesBackgroundOnly(int x, int y) const {
    return x < may_hit.x0 || x >= may_hit.x1 || y < may_hit.y0 || y >= may_hit.y1;
  }

  SampleKey Key(int x, int y, uint32_t replicate) const {
    return {.seed = spec.seed,
            .frame = spec.frame,
            .x = static_cast<uint32_t>(x),
            .y = static_cast<uint32_t>(y),
            .replicate = replicate,
            .kind = spec.sampler};
  }
  /// The settings of a pixel's paths.
  PathSettings SettingsAt(int x, int y) const {
    PathSettings here = settings;
    here.sure_survival = roulette.At(x, y);
    return here;
  }

  /// The ray of the sample `sampler` has been started on, and its weight in the pixel.
  template <typename Sampler>
  Ray CameraRay(int x, int y, const Sampler& sampler, float* weight) const {
    const FilterSample film = filter.Sample(sampler.Get2D(kPairFilm));
    *weight = film.weight;
    const Vec2f lens =
        camera.has_lens() ? SampleDiskBy(settings.routines, sampler.Get2D(kPairLens)) : Vec2f{0, 0};
    const float time = moves ? camera.TimeAt(sampler.Get2D(kPairTime).x) : 0;
    Ray ray = camera.GenerateRay({x + 0.5f + film.offset.x, y + 0.5f + film.offset.y}, lens, time);
    ray.time = time;
    return ray;
  }

  /// CameraRay for the lanes in `mask`, each of a pixel of its own: `get(pair)` gives the points of
  /// a pair of their samplers.
  template <typename Get>
  RayLanes CameraRays(Vec2Lanes pixel, Get get, MaskLanes mask, FloatLanes* weights) const {
    const Vec2Lanes film = get(kPairFilm);
    Vec2Lanes offset;
    ForEachLane(mask, [&](int lane) {
      const FilterSample sample = filter.Sample({film.x[lane], film.y[lane]});
      offset.x[lane] = sample.offset.x;
      offset.y[lane] = sample.offset.y;
      (*weights)[lane] = sample.weight;
    });
    const Vec2Lanes lens = camera.has_lens() ? SampleConcentricDisk(get(kPairLens)) : Vec2Lanes{};
    FloatLanes time = {};
    if (moves) {
      const FloatLanes u = get(kPairTime).x;
      ForEachLane(mask, [&](int lane) { time[lane] = camera.TimeAt(u[lane]); });
    }
    RayLanes rays = camera.GenerateRays({pixel.x + 0.5f + offset.x, pixel.y + 0.5f + offset.y},
                                        lens, time, mask);
    rays.time = time;
    return rays;
  }

  /// All samples of pixels [begin, end) of the unit, written to their places in `partial`. Where a
  /// pixel sees the background only, there is no path to trace.
  template <typename Sampler>
  void RenderPixels(const WorkUnit& unit, int64_t begin, int64_t end, Partial& partial,
                    DefectList& defects) const;

  /// The story of one sample, a line for each event.
  template <typename Sampler>
  std::string ReplaySample(int x, int y, uint32_t replicate, uint32_t sample) const;
};

}  // namespace strata
