#pragma once

#include <cstdint>
#include <memory>

#include "worker/integrator/camera.h"
#include "worker/integrator/path.h"
#include "worker/integrator/render.h"
#include "worker/sampling/filter.h"
#include "worker/sampling/sampler.h"
#include "worker/sampling/warp.h"
#include "worker/sampling/warp_lanes.h"

namespace strata {

class DefectList;

/// All that decides a job's samples.
struct Renderer::State {
  std::shared_ptr<const Scene> scene;
  JobSpec spec;
  PixelLayout layout;
  Camera camera;
  FilterSampler filter;
  PathSettings settings;

  SampleKey Key(int x, int y, uint32_t replicate) const {
    return {spec.seed, spec.frame, static_cast<uint32_t>(x), static_cast<uint32_t>(y), replicate};
  }

  /// The ray of the sample `sampler` has been started on, and its weight in the pixel.
  template <typename Sampler>
  Ray CameraRay(int x, int y, const Sampler& sampler, float* weight) const {
    const FilterSample film = filter.Sample(sampler.Get2D(kPairFilm));
    *weight = film.weight;
    const Vec2f lens =
        camera.has_lens() ? SampleConcentricDisk(sampler.Get2D(kPairLens)) : Vec2f{0, 0};
    return camera.GenerateRay({x + 0.5f + film.offset.x, y + 0.5f + film.offset.y}, lens);
  }

  /// CameraRay for the lanes in `mask`: `film` and `lens` are points of their samplers, the latter
  /// a function that gives them.
  template <typename Lens>
  RayLanes CameraRays(int x, int y, Vec2Lanes film, Lens lens, MaskLanes mask,
                      FloatLanes* weights) const {
    Vec2Lanes point;
    ForEachLane(mask, [&](int lane) {
      const FilterSample sample = filter.Sample({film.x[lane], film.y[lane]});
      point.x[lane] = x + 0.5f + sample.offset.x;
      point.y[lane] = y + 0.5f + sample.offset.y;
      (*weights)[lane] = sample.weight;
    });
    return camera.GenerateRays(point,
                               camera.has_lens() ? SampleConcentricDisk(lens()) : Vec2Lanes{});
  }

  /// All replicates of one pixel of the unit, written to its place in `partial`.
  template <typename Sampler>
  void RenderPixel(const WorkUnit& unit, int64_t pixel, Partial& partial,
                   DefectList& defects) const;

  /// The story of one sample, a line for each event.
  template <typename Sampler>
  std::string ReplaySample(int x, int y, uint32_t replicate, uint32_t sample) const;
};

}  // namespace strata
