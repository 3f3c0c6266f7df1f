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
/// Samples of a pixel that are kept until those before them, which may end later, are added.
constexpr uint64_t kHeldSamples = 4096;
/// Non-finite samples of a unit that are named.
constexpr size_t kMaxReplays = 4;

PixelValue ValueOf(const Renderer::State& job, const PathSample& sample, float weight) {
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
  if (channels.depth)
    add(sample.hit ? Dot(sample.position - job.camera.position(), job.camera.forward()) : 0);
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

/// The samples of one pixel in one unit, one replicate after the other.
struct PixelSamples {
  int x = 0, y = 0;
  SampleRange range;  ///< Not empty.

  uint64_t Count() const { return uint64_t{kReplicates} * range.Count(); }
  uint32_t Replicate(uint64_t s) const { return static_cast<uint32_t>(s / range.Count()); }
  uint32_t Index(uint64_t s) const {
    return range.begin + static_cast<uint32_t>(s % range.Count());
  }
};

/// Writes samples [first, last) to `values`, and returns the rays they took.
template <typename Sampler>
uint64_t TraceOneByOne(const Renderer::State& job, const PixelSamples& samples, uint64_t first,
                       uint64_t last, PixelValue* values) {
  uint64_t rays = 0;
  SilentObserver observer;
  for (uint64_t s = first; s < last;) {
    const uint32_t replicate = samples.Replicate(s);
    Sampler sampler(job.Key(samples.x, samples.y, replicate));
    for (; s < last && samples.Replicate(s) == replicate; ++s) {
      sampler.StartSample(samples.Index(s));
      float weight = 1;
      const Ray ray = job.CameraRay(samples.x, samples.y, sampler, &weight);
      const PathSample sample = PathTracer(*job.scene, job.settings, sampler, observer).Trace(ray);
      rays += sample.rays;
      values[s - first] = ValueOf(job, sample, weight);
    }
  }
  return rays;
}

template <typename Sampler>
uint64_t TraceSideBySide(const Renderer::State& job, const PixelSamples& samples, uint64_t first,
                         uint64_t last, PixelValue* values) {
  uint64_t rays = 0;
  FloatLanes weights = {};
  PathLanes<Sampler> lanes(*job.scene, job.settings, job.Key(samples.x, samples.y, 0));
  lanes.Trace(
      samples.range, first, last,
      [&](Vec2Lanes film, auto lens, MaskLanes mask) {
        return job.CameraRays(samples.x, samples.y, film, lens, mask, &weights);
      },
      [&](uint64_t s, int lane, const PathSample& sample) {
        rays += sample.rays;
        values[s - first] = ValueOf(job, sample, weights[lane]);
      });
  return rays;
}

}  // namespace

template <typename Sampler>
void Renderer::State::RenderPixel(const WorkUnit& unit, int64_t pixel, Partial& partial,
                                  DefectList& defects) const {
  const PixelSamples samples = {unit.pixels.x0 + static_cast<int>(pixel % unit.pixels.Width()),
                                unit.pixels.y0 + static_cast<int>(pixel / unit.pixels.Width()),
                                unit.RangeOf(pixel)};
  double* sums = &partial.values[static_cast<size_t>(pixel) * layout.Doubles()];
  PixelSum sum(layout);
  std::vector<PixelValue> values(std::min(samples.Count(), kHeldSamples));
  for (uint64_t first = 0, last; first < samples.Count(); first = last) {
    last = std::min(first + kHeldSamples, samples.Count());
    partial.rays[pixel] +=
        spec.kernel == KernelKind::kFast && settings.direct == DirectStrategy::kMis
            ? TraceSideBySide<Sampler>(*this, samples, first, last, values.data())
            : TraceOneByOne<Sampler>(*this, samples, first, last, values.data());
    for (uint64_t s = first; s < last; ++s) {
      const uint32_t replicate = samples.Replicate(s), index = samples.Index(s);
      if (!sum.Add(values[s - first]) && partial.nonfinite[pixel]++ == 0)
        defects.Add({pixel, replicate, index});
      if (index + 1 == samples.range.end) sum.FinishReplicate(static_cast<int>(replicate), sums);
    }
  }
  sum.Finish(sums);
  partial.samples[pixel] = samples.range.Count();
}

absl::StatusOr<std::unique_ptr<Renderer>> Renderer::Create(std::shared_ptr<const Scene> scene,
                                                           const JobSpec& spec,
                                                           DirectStrategy direct) {
  STRATA_RETURN_IF_ERROR(ValidateJobSpec(spec));
  STRATA_ASSIGN_OR_RETURN(const Camera camera,
                          Camera::Create(scene->camera(), spec.width, spec.height));
  auto state = std::make_unique<State>(State{
      .scene = std::move(scene),
      .spec = spec,
      .layout = LayoutOf(spec),
      .camera = camera,
      .filter = FilterSampler(spec.filter),
      .settings = {.max_depth = spec.max_depth, .direct = direct, .features = spec.channels.albedo},
  });
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
  const bool sobol = state_->spec.sampler == SamplerKind::kSobol;
  const int64_t pixels = unit.pixels.Pixels();
  pool.state_->Run((pixels + kBlockPixels - 1) / kBlockPixels, [&](int64_t block) {
    if (cancel && cancel->load(std::memory_order_relaxed)) return;
    const int64_t end = std::min((block + 1) * kBlockPixels, pixels);
    for (int64_t pixel = block * kBlockPixels; pixel < end; ++pixel) {
      if (sobol)
        state_->RenderPixel<SobolSampler>(unit, pixel, partial, defects);
      else
        state_->RenderPixel<IndependentSampler>(unit, pixel, partial, defects);
    }
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
