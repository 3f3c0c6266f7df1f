#include <algorithm>
#include <array>
#include <chrono>
#include <string>
#include <vector>

#include "cli/lab/measure.h"
#include "cli/lab/plates_scene.h"
#include "worker/integrator/render.h"
#include "worker/sampling/mis.h"

// Veach's plates, rendered by the project's own renderer with direct light alone, and independent
// random numbers, so that the spread of a pixel's samples is the variance of one.

namespace strata::lab {
namespace {

constexpr int kWidth = PlatesScene::kWidth, kHeight = PlatesScene::kHeight;

struct Strategy {
  const char* name;
  DirectStrategy direct;
  double beta = kPower;
};
constexpr std::array kStrategies = {
    Strategy{"light", DirectStrategy::kLightOnly},
    Strategy{"BSDF", DirectStrategy::kBsdfOnly},
    Strategy{"MIS, balance", DirectStrategy::kMis, kBalance},
    Strategy{"MIS, power", DirectStrategy::kMis},
    Strategy{"MIS, nearly maximum", DirectStrategy::kMis, kMaxMisBeta},
};

JobSpec SpecFor(const Settings& settings) {
  JobSpec spec;
  spec.bundle.scene = "plates.pbrt";
  spec.bundle.files = {{"plates.pbrt", DigestOf("plates"), 6}};
  spec.width = kWidth;
  spec.height = kHeight;
  spec.crop = {0, 0, kWidth, kHeight};
  spec.max_depth = 1;
  spec.sampler = SamplerKind::kIndependent;
  spec.kernel = KernelKind::kReference;  // The strategies are known to it alone.
  spec.spp =
      static_cast<uint32_t>((settings.samples + kReplicates - 1) / kReplicates * kReplicates);
  spec.seed = settings.seed;
  return spec;
}

/// Means and variances of single samples, of the green channel: the scene is grey.
struct Frame {
  std::vector<double> means, variances;
  double seconds = 0;  ///< Of one sample.
};

absl::StatusOr<Frame> Render(const PlatesScene& plates, const Strategy& strategy,
                             const Settings& settings) {
  JobSpec spec = SpecFor(settings);
  spec.strategy = strategy.direct;
  spec.mis_beta = strategy.beta;
  STRATA_ASSIGN_OR_RETURN(const std::unique_ptr<Renderer> renderer,
                          Renderer::Create(plates.scene, spec));
  RenderPool pool(1);
  const auto start = std::chrono::steady_clock::now();
  STRATA_ASSIGN_OR_RETURN(const Partial partial,
                          renderer->Render({{}, spec.crop, {{0, spec.spp / kReplicates}}}, pool));
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  Frame frame;
  const int64_t pixels = spec.crop.Pixels();
  frame.seconds = passed.count() / static_cast<double>(pixels) / spec.spp;
  constexpr int kGreen = 1;
  for (int64_t pixel = 0; pixel < pixels; ++pixel) {
    const double* values = &partial.values[pixel * partial.layout.Doubles()];
    double mean = 0;
    for (int r = 0; r < kReplicates; ++r) mean += values[partial.layout.Mean(r, kGreen)];
    frame.means.push_back(mean / kReplicates);
    frame.variances.push_back(values[partial.layout.M2(kGreen)] / (spec.spp - 1));
  }
  return frame;
}

/// The mean of the frame's values over the pixels.
double MeanOver(const std::vector<double>& values, const PixelRect& pixels) {
  double sum = 0;
  for (int y = pixels.y0; y < pixels.y1; ++y) {
    for (int x = pixels.x0; x < pixels.x1; ++x) sum += values[static_cast<size_t>(y) * kWidth + x];
  }
  return sum / static_cast<double>(pixels.Pixels());
}

}  // namespace

absl::StatusOr<Outcome> RunMis(const Settings& settings) {
  constexpr int kGap = 4, kColumns = static_cast<int>(kStrategies.size());
  STRATA_ASSIGN_OR_RETURN(const PlatesScene plates, MakePlatesScene());
  struct Region {
    const char* name;
    PixelRect pixels;
  };
  const std::array<Region, 5> regions = {{{"whole picture", {0, 0, kWidth, kHeight}},
                                          {"small lamp, smooth plate", plates.highlights[0][1]},
                                          {"small lamp, rough plate", plates.highlights[3][1]},
                                          {"large lamp, smooth plate", plates.highlights[0][3]},
                                          {"large lamp, rough plate", plates.highlights[3][3]}}};
  Outcome outcome;
  outcome.records.columns = {"where",   "sampling", "mean",     "standard error",
                             kVariance, kTime,      kEfficiency};
  Picture picture = Picture::White(kColumns * kWidth + (kColumns - 1) * kGap, kHeight);
  std::array<Frame, kStrategies.size()> frames;
  for (size_t i = 0; i < kStrategies.size(); ++i) {
    STRATA_ASSIGN_OR_RETURN(frames[i], Render(plates, kStrategies[i], settings));
    picture.Place(frames[i].means, kWidth, static_cast<int>(i) * (kWidth + kGap), 0);
  }
  for (const Region& region : regions) {
    for (size_t i = 0; i < kStrategies.size(); ++i) {
      const double variance = MeanOver(frames[i].variances, region.pixels);
      const double samples =
          static_cast<double>(SpecFor(settings).spp) * static_cast<double>(region.pixels.Pixels());
      outcome.records.rows.push_back({std::string(region.name), std::string(kStrategies[i].name),
                                      MeanOver(frames[i].means, region.pixels),
                                      std::sqrt(variance / samples), variance, frames[i].seconds,
                                      Efficiency(variance, frames[i].seconds)});
    }
  }
  outcome.figure = std::move(picture);
  outcome.caption =
      "From left to right: light sampling, BSDF sampling, both by the balance, the power and "
      "nearly the maximum heuristic (beta 1, 2 and 100).";
  outcome.remarks = {
      "Light sampling is bad where a large lamp is mirrored in a smooth plate: hardly any of its "
      "points lies in the narrow lobe. BSDF sampling is bad where a small lamp shines on a rough "
      "plate: hardly any direction meets it.",
      "Each sample's weight goes to the strategy that was likelier to make it (PBRT 2.2.3), and "
      "MIS is near the better of the two everywhere, for the time of both. All agree in the "
      "mean; V is that of one sample of a pixel, averaged over the pixels."};
  return outcome;
}

}  // namespace strata::lab
