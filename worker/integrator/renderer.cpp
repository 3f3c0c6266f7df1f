#include <algorithm>
#include <chrono>
#include <utility>
#include <vector>

#include "common/replay_command.h"
#include "common/sync.h"
#include "worker/integrator/path_lanes.h"
#include "worker/integrator/pixel_sum.h"
#include "worker/integrator/render_pool.h"
#include "worker/integrator/renderer_state.h"

namespace strata {

/// The first sample of a pixel that was NaN or infinite.
struct Defect {
  int64_t pixel = 0;  ///< Row-major in the unit.
  uint32_t replicate = 0, sample = 0;
};

/// Defects of a unit, found by all threads.
class DefectList {
 public:
  void Add(const Defect& defect) {
    MutexLock lock(mutex_);
    defects_.push_back(defect);
  }
  /// In the order of pixels, whichever thread came first. For when all threads are done.
  std::vector<Defect> Sorted() {
    MutexLock lock(mutex_);
    std::sort(defects_.begin(), defects_.end(),
              [](const Defect& a, const Defect& b) { return a.pixel < b.pixel; });
    return defects_;
  }

 private:
  Mutex mutex_;
  std::vector<Defect> defects_ STRATA_GUARDED_BY(mutex_);
};

namespace {

/// Pixels that a thread takes at a time.
constexpr int64_t kBlockPixels = 16;
/// Samples that are kept until those before them, which may end later, are added.
constexpr size_t kHeldSamples = 4096;
/// Non-finite samples of a unit that are named.
constexpr size_t kMaxReplays = 4;

/// `time` is that of the camera ray.
PixelValue ValueOf(const Renderer::State& job, const PathSample& sample, float weight, float time) {
  PixelValue value;
  value.color = sample.radiance * weight;
  if (job.layout.plain == 0) return value;
  const ExtraChannels& channels = job.spec.channels;
  int n = 0;
  const auto add = [&](float x) { value.plain[n++] = weight * x; };
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
  return value;
}

Partial EmptyPartial(const WorkUnit& unit, const PixelLayout& layout) {
  const size_t pixels = static_cast<size_t>(unit.pixels.Pixels());
  Partial partial;
  partial.unit = unit.id;
  partial.pixels = unit.pixels;
  partial.layout = layout;
  partial.samples.resize(pixels);
  partial.values.resize(pixels * layout.Doubles());
  partial.rays.resize(pixels);
  partial.nonfinite.resize(pixels);
  return partial;
}

absl::Status CheckUnit(const WorkUnit& unit, const JobSpec& spec) {
  const PixelRect& p = unit.pixels;
  if (p.x0 < 0 || p.y0 < 0 || p.x0 >= p.x1 || p.y0 >= p.y1 || p.x1 > spec.width ||
      p.y1 > spec.height)
    return absl::InvalidArgumentError(
        absl::StrCat("unit: its pixels [", p.x0, ", ", p.x1, ") x [", p.y0, ", ", p.y1,
                     ") are not inside the frame of ", spec.width, "x", spec.height));
  if (unit.ranges.size() != 1 && unit.ranges.size() != static_cast<size_t>(p.Pixels()))
    return absl::InvalidArgumentError(absl::StrCat("unit: ", unit.ranges.size(),
                                                   " sample ranges for ", p.Pixels(),
                                                   " pixels; give one, or one for each"));
  for (const SampleRange& range : unit.ranges)
    if (range.begin > range.end)
      return absl::InvalidArgumentError("unit: a sample range ends before it begins");
  return absl::OkStatus();
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
  int x() const { return unit_.pixels.x0 + static_cast<int>(pixel_ % unit_.pixels.Width()); }
  int y() const { return unit_.pixels.y0 + static_cast<int>(pixel_ / unit_.pixels.Width()); }
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
    range_ = unit_.RangeOf(pixel_);
    replicate_ = 0;
    index_ = range_.begin;
  }

  const WorkUnit& unit_;
  int64_t pixel_, end_;
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
    held.push_back({ValueOf(job, sample, weight, ray.time), sample.rays});
  }
}

template <typename Sampler>
void TraceSideBySide(const Renderer::State& job, TracedSamples<Sampler>& samples,
                     std::vector<HeldSample>& held) {
  held.clear();
  std::array<size_t, kLanes> place;
  Vec2Lanes pixel;
  FloatLanes weights = {}, times = {};
  const bool same_roulette = job.spec.roulette != RouletteKind::kEfficiency;
  PathLanes<Sampler> lanes(*job.scene, job.SettingsAt(0, 0));
  lanes.Trace(
      [&](int lane, SamplerLanes<Sampler>& samplers) {
        if (samples.AtEnd() || held.size() == kHeldSamples) return false;
        samples.Next();
        samplers.StartSample(lane, samples.sampler(), samples.index());
        if (!same_roulette) lanes.SetSureSurvival(lane, job.roulette.At(samples.x(), samples.y()));
        pixel.x[lane] = static_cast<float>(samples.x());
        pixel.y[lane] = static_cast<float>(samples.y());
        place[lane] = held.size();
        held.emplace_back();
        return true;
      },
      [&](auto get, MaskLanes mask) {
        const RayLanes starting = job.CameraRays(pixel, get, mask, &weights);
        times = mask ? starting.time : times;
        return starting;
      },
      [&](int lane, const PathSample& sample) {
        held[place[lane]] = {ValueOf(job, sample, weights[lane], times[lane]), sample.rays};
      });
}

}  // namespace

template <typename Sampler>
void Renderer::State::RenderPixels(const WorkUnit& unit, int64_t begin, int64_t end,
                                   Partial& partial, DefectList& defects) const {
  SampleCursor cursor(unit, begin, end);
  TracedSamples<Sampler> samples(*this, cursor);
  const bool side_by_side =
      spec.kernel == KernelKind::kFast && settings.direct == DirectStrategy::kMis;
  std::vector<HeldSample> held;
  held.reserve(kHeldSamples);
  PixelSum sum(layout);
  while (!cursor.AtEnd()) {
    if (side_by_side)
      TraceSideBySide(*this, samples, held);
    else
      TraceOneByOne(*this, samples, held);
    for (const HeldSample& sample : held) {
      const int64_t pixel = cursor.pixel();
      double* sums = &partial.values[static_cast<size_t>(pixel) * layout.Doubles()];
      partial.rays[pixel] += sample.rays;
      if (!sum.Add(sample.value) && partial.nonfinite[pixel]++ == 0)
        defects.Add({pixel, cursor.replicate(), cursor.index()});
      if (cursor.LastOfReplicate()) sum.FinishReplicate(static_cast<int>(cursor.replicate()), sums);
      if (cursor.LastOfPixel()) {
        sum.Finish(sums);
        sum = PixelSum(layout);
        partial.samples[pixel] = unit.RangeOf(pixel).Count();
      }
      cursor.Advance();
    }
  }
}

absl::StatusOr<std::unique_ptr<Renderer>> Renderer::Create(std::shared_ptr<const Scene> scene,
                                                           const JobSpec& spec) {
  STRATA_RETURN_IF_ERROR(ValidateJobSpec(spec));
  STRATA_ASSIGN_OR_RETURN(const Camera camera,
                          Camera::Create(scene->camera(), spec.width, spec.height));
  const bool moves = scene->geometry().moves() || camera.moves();
  auto state = std::make_unique<State>(State{
      .scene = std::move(scene),
      .spec = spec,
      .layout = LayoutOf(spec),
      .camera = camera,
      .filter = FilterSampler(spec.filter),
      .settings = {.max_depth = spec.max_depth,
                   .direct = spec.strategy,
                   .features = spec.channels.albedo},
      .roulette =
          RouletteMap(spec.width, spec.height,
                      spec.roulette == RouletteKind::kOff ? 0 : PathSettings().sure_survival),
      .moves = moves,
  });
  if (spec.roulette == RouletteKind::kEfficiency) state->roulette = MeasureRoulette(*state);
  return std::unique_ptr<Renderer>(new Renderer(std::move(state)));
}

Renderer::Renderer(std::unique_ptr<State> state) : state_(std::move(state)) {}
Renderer::~Renderer() = default;

absl::StatusOr<Partial> Renderer::Render(const WorkUnit& unit, RenderPool& pool,
                                         const std::atomic<bool>* cancel) const {
  STRATA_RETURN_IF_ERROR(CheckUnit(unit, state_->spec));
  const auto start = std::chrono::steady_clock::now();
  Partial partial = EmptyPartial(unit, state_->layout);
  DefectList defects;
  const int64_t pixels = unit.pixels.Pixels();
  pool.state_->Run((pixels + kBlockPixels - 1) / kBlockPixels, [&](int64_t block) {
    if (cancel && cancel->load(std::memory_order_relaxed)) return;
    const int64_t end = std::min((block + 1) * kBlockPixels, pixels);
    WithSampler(state_->spec.sampler, [&]<typename Sampler>() {
      state_->RenderPixels<Sampler>(unit, block * kBlockPixels, end, partial, defects);
    });
  });
  if (cancel && cancel->load(std::memory_order_relaxed))
    return absl::CancelledError("the unit was cancelled while it was rendered");
  for (const Defect& defect : defects.Sorted()) {
    if (partial.replays.size() == kMaxReplays) break;
    const int x = unit.pixels.x0 + static_cast<int>(defect.pixel % unit.pixels.Width());
    const int y = unit.pixels.y0 + static_cast<int>(defect.pixel / unit.pixels.Width());
    partial.replays.push_back(ReplayCommand(state_->spec, x, y, defect.replicate, defect.sample));
  }
  partial.render_seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return partial;
}

}  // namespace strata
