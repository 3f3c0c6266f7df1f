#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include "worker/integrator/defect_list.h"
#include "worker/integrator/path_lanes.h"
#include "worker/integrator/pixel_sum.h"
#include "worker/integrator/renderer_state.h"
#include "worker/math/cpu_clones.h"

// Renderer::State::RenderPixels, which is compiled for each sampler in a file of its own: the
// kernels are most of what there is to compile.

namespace strata {
namespace render_detail {

/// Samples that are kept until those before them, which may end later, are added.
inline constexpr size_t kHeldSamples = 4096;

/// `time` is that of the camera ray.
inline void SetValue(const Renderer::State& job, const PathSample& sample, float weight, float time,
                     PixelValue* value) {
  value->color = sample.radiance * weight;
  if (job.layout.plain == 0) return;
  const ExtraChannels& channels = job.spec.channels;
  int n = 0;
  const auto add = [&](float x) { value->plain[n++] = weight * x; };
  if (channels.alpha) add(sample.hit ? 1 : 0);
  if (channels.albedo) {
    add(sample.albedo.r);
    add(sample.albedo.g);
    add(sample.albedo.b);
  }
  if (channels.normal) {
    add(sample.normal.x);
    add(sample.normal.y);
    add(sample.normal.z);
  }
  if (channels.depth) add(sample.hit ? job.camera.Depth(sample.position, time) : 0);
}

/// Goes through the samples of pixels [pixel, end) of a unit: one pixel after the other, in each
/// one replicate after the other.
class SampleCursor {
 public:
  SampleCursor(const WorkUnit& unit, int64_t pixel, int64_t end)
      : unit_(unit), pixel_(pixel), end_(end) {
    StartPixel();
  }

  bool AtEnd() const { return pixel_ == end_; }
  int64_t pixel() const { return pixel_; }  ///< Row-major in the unit.
  int x() const { return x_; }
  int y() const { return y_; }
  uint32_t replicate() const { return replicate_; }
  uint32_t index() const { return index_; }
  bool FirstOfReplicate() const { return index_ == range_.begin; }
  bool LastOfReplicate() const { return index_ + 1 == range_.end; }
  bool LastOfPixel() const { return LastOfReplicate() && replicate_ + 1 == kReplicates; }

  void Advance() {
    if (++index_ < range_.end) return;
    index_ = range_.begin;
    if (++replicate_ < kReplicates) return;
    ++pixel_;
    StartPixel();
  }

 private:
  void StartPixel() {
    while (pixel_ < end_ && unit_.RangeOf(pixel_).Count() == 0) ++pixel_;
    if (AtEnd()) return;
    x_ = unit_.pixels.x0 + static_cast<int>(pixel_ % unit_.pixels.Width());
    y_ = unit_.pixels.y0 + static_cast<int>(pixel_ / unit_.pixels.Width());
    range_ = unit_.RangeOf(pixel_);
    replicate_ = 0;
    index_ = range_.begin;
  }

  const WorkUnit& unit_;
  int64_t pixel_, end_;
  int x_ = 0, y_ = 0;
  SampleRange range_;
  uint32_t replicate_ = 0, index_ = 0;
};

/// A sample that has been traced and not yet added to its pixel.
struct HeldSample {
  PixelValue value;
  uint32_t rays = 0;
};

/// A cursor that keeps the sampler of the replicate it stands in.
template <typename Sampler>
class TracedSamples {
 public:
  TracedSamples(const Renderer::State& job, const SampleCursor& start)
      : job_(job), cursor_(start), sampler_(SampleKey{}) {}

  bool AtEnd() const { return cursor_.AtEnd(); }
  /// Goes to the next sample, which is now the current one. Not at the end.
  void Next() {
    x_ = cursor_.x();
    y_ = cursor_.y();
    index_ = cursor_.index();
    if (cursor_.FirstOfReplicate()) sampler_ = Sampler(job_.Key(x_, y_, cursor_.replicate()));
    cursor_.Advance();
  }
  int x() const { return x_; }
  int y() const { return y_; }
  uint32_t index() const { return index_; }
  Sampler& sampler() { return sampler_; }

 private:
  const Renderer::State& job_;
  SampleCursor cursor_;
  Sampler sampler_;
  int x_ = 0, y_ = 0;
  uint32_t index_ = 0;
};

/// Writes the next samples to `held`, at most kHeldSamples.
template <typename Sampler>
void TraceOneByOne(const Renderer::State& job, TracedSamples<Sampler>& samples,
                   std::vector<HeldSample>& held) {
  SilentObserver observer;
  for (held.clear(); !samples.AtEnd() && held.size() < kHeldSamples;) {
    samples.Next();
    Sampler& sampler = samples.sampler();
    sampler.StartSample(samples.index());
    float weight = 1;
    const Ray ray = job.CameraRay(samples.x(), samples.y(), sampler, &weight);
    const PathSettings settings = job.SettingsAt(samples.x(), samples.y());
    const PathSample sample = PathTracer(*job.scene, settings, sampler, observer).Trace(ray);
    HeldSample& to = held.emplace_back();
    to.rays = sample.rays;
    SetValue(job, sample, weight, ray.time, &to.value);
  }
}

/// flatten: all that is called is inlined, visits of variants too; left to itself gcc 12 calls it
/// piece by piece and passes results in memory.
template <typename Sampler, uint32_t kHas>
STRATA_CPU_CLONES [[gnu::flatten]] void TraceWith(const Renderer::State& job,
                                                  TracedSamples<Sampler>& samples,
                                                  std::vector<HeldSample>& held) {
  held.clear();
  /// What is kept of a path's sample.
  struct Begun {
    size_t place = 0;  ///< In `held`.
    float x = 0, y = 0, weight = 0, time = 0;
  };
  std::array<Begun, kPaths> begun;
  const bool same_roulette = job.spec.roulette != RouletteKind::kEfficiency;
  PathLanes<Sampler, kHas> lanes(*job.scene, job.SettingsAt(0, 0));
  lanes.Trace(
      [&](int path, SamplerLanes<Sampler>& samplers) {
        if (samples.AtEnd() || held.size() == kHeldSamples) return false;
        samples.Next();
        samplers.StartSample(path, samples.sampler(), samples.index());
        if (!same_roulette) lanes.SetSureSurvival(path, job.roulette.At(samples.x(), samples.y()));
        begun[path] = {held.size(), static_cast<float>(samples.x()),
                       static_cast<float>(samples.y())};
        held.emplace_back();
        return true;
      },
      [&](auto get, const PathBatch& batch) {
        Vec2Lanes pixel;
        ForEachLane(batch.mask, [&](int lane) {
          pixel.x[lane] = begun[batch.path.at[lane]].x;
          pixel.y[lane] = begun[batch.path.at[lane]].y;
        });
        FloatLanes weights = {};
        const RayLanes rays = job.CameraRays(pixel, get, batch.mask, &weights);
        ForEachLane(batch.mask, [&](int lane) {
          begun[batch.path.at[lane]].weight = weights[lane];
          begun[batch.path.at[lane]].time = rays.time[lane];
        });
        return rays;
      },
      [&](int path, const PathSample& sample) {
        const Begun& of = begun[path];
        HeldSample& to = held[of.place];
        to.rays = sample.rays;
        SetValue(job, sample, of.weight, of.time, &to.value);
      });
}

/// By the smallest kernel there is that covers the scene.
template <typename Sampler>
void TraceSideBySide(const Renderer::State& job, TracedSamples<Sampler>& samples,
                     std::vector<HeldSample>& held) {
  // What rooms have, glass that absorbs too; other samplers than the default are not worth kernels
  // of their own.
  constexpr uint32_t kIndoors = kOtherMaterials | kManyLights | kMedia;
  const uint32_t needed = job.scene->features();
  if constexpr (std::is_same_v<Sampler, SobolSampler>) {
    if (needed == kNoFeatures) return TraceWith<Sampler, kNoFeatures>(job, samples, held);
    if ((needed & ~kIndoors) == 0) return TraceWith<Sampler, kIndoors>(job, samples, held);
  }
  TraceWith<Sampler, kAllFeatures>(job, samples, held);
}

/// As the others, for pixels that see the background only.
template <typename Sampler>
void SeeBackground(const Renderer::State& job, TracedSamples<Sampler>& samples,
                   std::vector<HeldSample>& held) {
  const LightSet& lights = job.scene->lights();
  for (held.clear(); !samples.AtEnd() && held.size() < kHeldSamples;) {
    samples.Next();
    PathSample sample;
    float weight = 1, time = 0;
    if (!lights.environments().empty()) {
      samples.sampler().StartSample(samples.index());
      const Ray ray = job.CameraRay(samples.x(), samples.y(), samples.sampler(), &weight);
      time = ray.time;
      for (uint32_t light : lights.environments())
        sample.radiance += lights.EnvironmentLe(light, ray.origin, ray.direction);
    }
    HeldSample& to = held.emplace_back();
    to.rays = 1;
    SetValue(job, sample, weight, time, &to.value);
  }
}

/// The samples of pixels [begin, end), of which all see the background only, or none.
template <typename Sampler>
void RenderAlike(const Renderer::State& job, const WorkUnit& unit, int64_t begin, int64_t end,
                 bool background, Partial& partial, DefectList& defects) {
  SampleCursor cursor(unit, begin, end);
  TracedSamples<Sampler> samples(job, cursor);
  // What is there to compare with goes one by one.
  const bool side_by_side =
      job.spec.kernel == KernelKind::kFast && job.settings.direct == DirectStrategy::kMis &&
      job.settings.mis_beta == kPower && job.settings.routines == SamplingRoutines::kPreserving;
  std::vector<HeldSample> held;
  held.reserve(kHeldSamples);
  PixelSum sum(job.layout);
  while (!cursor.AtEnd()) {
    if (background)
      SeeBackground(job, samples, held);
    else if (side_by_side)
      TraceSideBySide(job, samples, held);
    else
      TraceOneByOne(job, samples, held);
    for (const HeldSample& sample : held) {
      const int64_t pixel = cursor.pixel();
      double* sums = &partial.values[static_cast<size_t>(pixel) * job.layout.Doubles()];
      partial.rays[pixel] += sample.rays;
      if (!sum.Add(sample.value) && partial.nonfinite[pixel]++ == 0)
        defects.Add({pixel, cursor.replicate(), cursor.index()});
      if (cursor.LastOfReplicate()) sum.FinishReplicate(static_cast<int>(cursor.replicate()), sums);
      if (cursor.LastOfPixel()) {
        sum.Finish(sums);
        sum = PixelSum(job.layout);
        partial.samples[pixel] = unit.RangeOf(pixel).Count();
      }
      cursor.Advance();
    }
  }
}

}  // namespace render_detail

template <typename Sampler>
void Renderer::State::RenderPixels(const WorkUnit& unit, int64_t begin, int64_t end,
                                   Partial& partial, DefectList& defects) const {
  const auto background = [&](int64_t pixel) {
    return SeesBackgroundOnly(unit.pixels.x0 + static_cast<int>(pixel % unit.pixels.Width()),
                              unit.pixels.y0 + static_cast<int>(pixel / unit.pixels.Width()));
  };
  while (begin < end) {
    const bool alike = background(begin);
    int64_t next = begin + 1;
    while (next < end && background(next) == alike) ++next;
    render_detail::RenderAlike<Sampler>(*this, unit, begin, next, alike, partial, defects);
    begin = next;
  }
}

}  // namespace strata
