#include "worker/integrator/roulette_map.h"

#include <algorithm>
#include <cmath>

#include "worker/integrator/renderer_state.h"

namespace strata {
namespace {

/// Pixels of a part, and paths of each: two, whose difference is free of what pixels differ by.
constexpr uint32_t kPixels = 32;
/// Thresholds stay where noise times time is near its least on all scenes tried
/// (docs/performance.md): the pilot's independent samples vary more than stratified ones, and few
/// of them may find what makes a part vary.
constexpr double kLeastSure = 0.25, kMostSure = 1;

/// What the rest of a path came to, at one place where roulette could have ended it.
struct Decision {
  float throughput;
  double found;   ///< Luminance so far.
  uint32_t rays;  ///< So far.
};

/// Notes where roulette is played, and what the path had found and cost by then.
class PilotObserver {
 public:
  void OnFlight(const Flight& flight) {
    Find(beta_ * flight.emitted);
    beta_ *= flight.weight;
  }
  void OnMiss(const Ray&, Rgb radiance, float weight) { Find(beta_ * radiance * weight); }
  void OnVertex(int depth, const Ray&, const PathVertex&, Rgb beta) {
    depth_ = depth;
    beta_ = beta;
    ++rays_;
  }
  void OnEmission(uint32_t, Rgb radiance, float weight) { Find(beta_ * radiance * weight); }
  void OnLight(const DirectSample& direct, Rgb contribution) {
    if (direct.traced) ++rays_;
    Find(contribution);
  }
  void OnBsdf(const std::optional<BsdfSample>& sample, Vec3f) {
    if (!sample) return;
    beta_ *= sample->weight;
    if (sample->transmission) eta_scale_ *= sample->eta * sample->eta;
    const float throughput = MaxComponent(beta_) * eta_scale_;
    if (depth_ >= 1 && throughput > 0) decisions_.push_back({throughput, found_, rays_});
  }
  void OnRoulette(float survival, bool) { beta_ *= 1 / survival; }

  const std::vector<Decision>& decisions() const { return decisions_; }

 private:
  void Find(Rgb radiance) { found_ += Luminance(radiance); }

  int depth_ = 0;
  Rgb beta_ = {1, 1, 1};
  float eta_scale_ = 1;
  double found_ = 0;
  uint32_t rays_ = 0;
  std::vector<Decision> decisions_;
};

/// Sums over paths, or over parts of the frame.
struct PilotSums {
  double variance = 0, rays = 0, paths = 0;
  double rest_squares = 0, rest_rays = 0, rests = 0;  ///< Of decisions.

  void Add(const PilotSums& other) {
    variance += other.variance;
    rays += other.rays;
    paths += other.paths;
    rest_squares += other.rest_squares;
    rest_rays += other.rest_rays;
    rests += other.rests;
  }
};

/// Traces one path and returns its luminance.
double TracePilot(const Renderer::State& job, int x, int y, uint32_t sample, PilotSums& sums) {
  // Replicates of jobs are less.
  IndependentSampler sampler({.frame = job.spec.frame,
                              .x = static_cast<uint32_t>(x),
                              .y = static_cast<uint32_t>(y),
                              .replicate = kReplicates});
  sampler.StartSample(sample);
  float weight = 1;
  const Ray ray = job.CameraRay(x, y, sampler, &weight);
  PilotObserver observer;
  const PathSample path = PathTracer(*job.scene, job.settings, sampler, observer).Trace(ray);
  const double luminance = Luminance(path.radiance);
  if (!std::isfinite(luminance)) return 0;
  sums.rays += path.rays;
  ++sums.paths;
  for (const Decision& decision : observer.decisions()) {
    const double rest = (luminance - decision.found) / decision.throughput;
    sums.rest_squares += rest * rest;
    sums.rest_rays += path.rays - decision.rays;
    ++sums.rests;
  }
  return luminance;
}

PilotSums MeasurePart(const Renderer::State& job, const PixelRect& part) {
  PilotSums sums;
  for (uint32_t i = 0; i < kPixels; ++i) {
    const uint64_t bits =
        HashCombine((static_cast<uint64_t>(part.x0) << 32) | static_cast<uint32_t>(part.y0), i);
    const int x = part.x0 + static_cast<int>((bits >> 32) % static_cast<uint32_t>(part.Width()));
    const int y =
        part.y0 + static_cast<int>((bits & 0xffffffff) % static_cast<uint32_t>(part.Height()));
    const double a = TracePilot(job, x, y, 2 * i, sums);
    const double difference = a - TracePilot(job, x, y, 2 * i + 1, sums);
    sums.variance += difference * difference;  // Twice that of one, and there are two.
  }
  return sums;
}

}  // namespace

RouletteMap MeasureRoulette(const Renderer::State& job) {
  RouletteMap map(job.spec.width, job.spec.height, job.settings.sure_survival);
  std::vector<PilotSums> parts;
  PilotSums all;
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      parts.push_back(MeasurePart(job, {map.ColumnBegin(column), map.RowBegin(row),
                                        map.ColumnBegin(column + 1), map.RowBegin(row + 1)}));
      all.Add(parts.back());
    }
  }
  if (!(all.rest_squares > 0 && all.rest_rays > 0)) return map;
  const double rest = std::sqrt(all.rest_squares / all.rest_rays);
  for (int row = 0; row < map.rows(); ++row) {
    for (int column = 0; column < map.columns(); ++column) {
      PilotSums around;
      for (int v = std::max(row - 1, 0); v <= std::min(row + 1, map.rows() - 1); ++v) {
        for (int u = std::max(column - 1, 0); u <= std::min(column + 1, map.columns() - 1); ++u)
          around.Add(parts[static_cast<size_t>(v) * map.columns() + u]);
      }
      const double own = std::sqrt(around.variance / std::max(around.rays, 1.0));
      map.Cell(column, row) = static_cast<float>(std::clamp(own / rest, kLeastSure, kMostSure));
    }
  }
  return map;
}

}  // namespace strata
