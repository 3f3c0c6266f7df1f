#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "common/replay_command.h"
#include "worker/integrator/defect_list.h"
#include "worker/integrator/render_pool.h"
#include "worker/integrator/renderer_state.h"

namespace strata {
namespace {

/// Pixels that a thread takes at a time.
constexpr int64_t kBlockPixels = 16;
/// Non-finite samples of a unit that are named.
constexpr size_t kMaxReplays = 4;

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

/// The pixels of the frame whose camera rays may meet something.
PixelRect PixelsThatMayHit(const Scene& scene, const Camera& camera, const JobSpec& spec) {
  const PixelRect all = {0, 0, spec.width, spec.height};
  if (!scene.options().skip_background) return all;
  // Within a medium all is seen through it, and borders of media are met like surfaces.
  if (scene.media().camera_medium() != kNoMedium || scene.media().borders()) return all;
  const std::optional<Camera::FrameRect> rect = camera.RectOf(scene.geometry().bounds());
  if (!rect) return all;
  // A sample is taken within the filter's radius of the middle of its pixel; another pixel is for
  // the rounding of rays.
  const double reach_x = spec.filter.radius_x + 1, reach_y = spec.filter.radius_y + 1;
  const auto in = [](double v, int end) {
    return static_cast<int>(std::clamp(v, 0.0, static_cast<double>(end)));
  };
  return {in(std::floor(rect->x0 - 0.5 - reach_x), spec.width),
          in(std::floor(rect->y0 - 0.5 - reach_y), spec.height),
          in(std::ceil(rect->x1 + 0.5 + reach_x), spec.width),
          in(std::ceil(rect->y1 + 0.5 + reach_y), spec.height)};
}

}  // namespace

absl::StatusOr<std::unique_ptr<Renderer>> Renderer::Create(std::shared_ptr<const Scene> scene,
                                                           const JobSpec& spec) {
  STRATA_RETURN_IF_ERROR(ValidateJobSpec(spec));
  STRATA_ASSIGN_OR_RETURN(const Camera camera,
                          Camera::Create(scene->camera(), spec.width, spec.height));
  const bool moves = scene->geometry().moves() || camera.moves();
  auto state = std::make_unique<State>(State{
      .scene = scene,
      .spec = spec,
      .layout = LayoutOf(spec),
      .camera = camera,
      .filter = FilterSampler(spec.filter),
      .settings = {.max_depth = spec.max_depth,
                   .direct = spec.strategy,
                   .mis_beta = spec.mis_beta,
                   .routines = spec.routines,
                   .sure_shadow = spec.roulette == RouletteKind::kOff ? 0 : kSureShadow,
                   .first_hit = LayoutOf(spec).plain > 0,
                   .albedo = spec.channels.albedo},
      .roulette =
          RouletteMap(spec.width, spec.height,
                      spec.roulette == RouletteKind::kOff ? 0 : PathSettings().sure_survival),
      .moves = moves,
      .may_hit = PixelsThatMayHit(*scene, camera, spec),
  });
  if (spec.roulette == RouletteKind::kEfficiency) state->roulette = MeasureRoulette(*state);
  return std::unique_ptr<Renderer>(new Renderer(std::move(state)));
}

int64_t Renderer::BackgroundPixels() const {
  const PixelRect &crop = state_->spec.crop, &may_hit = state_->may_hit;
  const int width = std::min(crop.x1, may_hit.x1) - std::max(crop.x0, may_hit.x0);
  const int height = std::min(crop.y1, may_hit.y1) - std::max(crop.y0, may_hit.y0);
  return crop.Pixels() - int64_t{std::max(width, 0)} * std::max(height, 0);
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
