// Whether stopping at a target biases the estimates it stops at; docs/accuracy.md, "Targets".

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <string>

#include "tests/farm/synthetic_job.h"

namespace strata {
namespace {

SyntheticImage Flat(const SyntheticPixel& pixel) {
  return SyntheticImage({32, 32}, [&](size_t, size_t) { return pixel; });
}
SyntheticImage NormalNoise() { return Flat({0.3, 0, 0, 0.5}); }
SyntheticImage Fireflies() { return Flat({0.05, 2, 0.1, 0}); }

/// Renders to the end.
using Job = std::function<void(SyntheticRender&)>;

Job FarmJob(TargetKind target, double value, AllocationKind allocation = AllocationKind::kRing) {
  const JobSpec spec = SyntheticSpec({32, 32}, target, value, allocation);
  return [spec](SyntheticRender& render) { EXPECT_TRUE(RenderJob(render, spec).last.target_met); };
}

/// The control: each pixel goes on until its own interval is narrow enough.
void RenderByOwnInterval(SyntheticRender& render, double error) {
  render.RenderTo(4);
  for (bool goes_on = true; goes_on;) {
    const PixelStatistics now = render.Statistics();
    std::vector<uint32_t> ends = now.samples;
    for (size_t i = 0; i < ends.size(); ++i) {
      const double widest = error * std::max(now.luminance[i], 0.01) / kStudent25;
      const double wanted = std::ceil(now.variance[0][i] / (widest * widest) / kReplicates);
      ends[i] = static_cast<uint32_t>(std::clamp<double>(wanted, ends[i], 1 << 13));
    }
    goes_on = ends != now.samples;
    render.RenderTo(ends);
  }
}

struct Experiment {
  std::string name;
  SyntheticImage image;
  Job job;
};

/// In standard errors.
struct Bias {
  double mean = 0, error = 0;
};

Bias BiasOf(const Experiment& experiment, int seeds) {
  const SyntheticPixel& pixel = experiment.image.pixels()[0];
  const double pixels = static_cast<double>(experiment.image.pixels().size());
  double sum = 0, squares = 0, samples = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    SyntheticRender render(experiment.image, 7000 + static_cast<uint64_t>(seed));
    experiment.job(render);
    double error = 0;
    for (size_t i = 0; i < experiment.image.pixels().size(); ++i) {
      error += (render.Mean(i) - pixel.Mean()) / pixels;
    }
    sum += error;
    squares += error * error;
    samples += render.AverageSamples();
  }
  const double mean = sum / seeds;
  const double standard_error = std::sqrt(pixel.Variance() / (samples / seeds));
  const double deviation = std::sqrt((squares / seeds - mean * mean) / (seeds - 1));
  return {mean / standard_error, deviation / standard_error};
}

std::vector<Experiment> Targets() {
  using enum TargetKind;
  return {{"normal, --error 0.4", NormalNoise(), FarmJob(kRelativeError, 0.4)},
          {"normal, --rmse 0.05", NormalNoise(), FarmJob(kRmse, 0.05)},
          {"skewed, --error 0.5", Fireflies(), FarmJob(kRelativeError, 0.5)},
          {"skewed, --rmse 0.05", Fireflies(), FarmJob(kRmse, 0.05)}};
}

std::vector<Experiment> UniformTargets() {
  using enum TargetKind;
  constexpr AllocationKind kUniform = AllocationKind::kUniform;
  return {{"skewed, uniform --error 0.5", Fireflies(), FarmJob(kRelativeError, 0.5, kUniform)},
          {"skewed, uniform --rmse 0.05", Fireflies(), FarmJob(kRmse, 0.05, kUniform)}};
}

std::vector<Experiment> Controls() {
  return {{"normal, own interval 0.4", NormalNoise(),
           [](SyntheticRender& render) { RenderByOwnInterval(render, 0.4); }},
          {"skewed, own interval 0.5", Fireflies(),
           [](SyntheticRender& render) { RenderByOwnInterval(render, 0.5); }}};
}

Bias PrintedBias(const Experiment& experiment, int seeds) {
  const Bias bias = BiasOf(experiment, seeds);
  std::printf("%-28s %8.4f +- %.4f standard errors, %d renders\n", experiment.name.c_str(),
              bias.mean, bias.error, seeds);
  return bias;
}

// 3.5 standard errors of renders, which are independent: p = 0.0005 for each of six.
TEST(TargetBiasTest, NoneShows) {
  std::vector<Experiment> experiments = Targets();
  for (Experiment& uniform : UniformTargets()) experiments.push_back(std::move(uniform));
  for (const Experiment& experiment : experiments) {
    const Bias bias = PrintedBias(experiment, SeedsOr(500));
    EXPECT_LT(std::fabs(bias.mean), 3.5 * bias.error) << experiment.name;
    EXPECT_LT(bias.error, 0.002);
  }
}

TEST(TargetBiasTest, StoppingByOnesOwnIntervalHasMuch) {
  for (const Experiment& experiment : Controls()) {
    const Bias bias = PrintedBias(experiment, SeedsOr(500) / 10);
    EXPECT_GT(std::fabs(bias.mean), 0.02) << experiment.name;
    EXPECT_GT(std::fabs(bias.mean), 5 * bias.error) << experiment.name;
  }
}

/// What a pixel's own samples do to its count N, the samples of all others being held.
struct Influence {
  double changed = 0;  ///< P(N != n) with n the most frequent count.
  double wald = 0;     ///< E[N] sd(1/N).
};

Influence InfluenceOf(const Experiment& experiment, int redraws) {
  constexpr int kPixels = 64;
  Influence influence;
  for (int k = 0; k < kPixels; ++k) {
    const size_t pixel = static_cast<size_t>(k) * 16 + static_cast<size_t>(k) % 16;
    std::map<uint32_t, int> counts;
    double sum = 0, inverse = 0, squares = 0;
    for (int redraw = 0; redraw < redraws; ++redraw) {
      SyntheticRender render(experiment.image, 300 + static_cast<uint64_t>(k));
      render.Redraw(pixel, 9000 + static_cast<uint64_t>(redraw));
      experiment.job(render);
      const double n = render.Samples(pixel);
      ++counts[render.Samples(pixel)];
      sum += n / redraws;
      inverse += 1 / n / redraws;
      squares += 1 / (n * n) / redraws;
    }
    const auto fewer = [](const auto& a, const auto& b) { return a.second < b.second; };
    const auto usual = std::max_element(counts.begin(), counts.end(), fewer);
    influence.changed += (1 - usual->second / double(redraws)) / kPixels;
    influence.wald += sum * std::sqrt(std::max(squares - inverse * inverse, 0.0)) / kPixels;
  }
  std::printf("%-28s P(N != n) %.3f, E[N] sd(1/N) %.4f\n", experiment.name.c_str(),
              influence.changed, influence.wald);
  return influence;
}

TEST(TargetBiasTest, APixelsOwnSamplesHardlyMoveItsCount) {
  const int redraws = std::min(SeedsOr(8), 40);
  for (const Experiment& experiment : Targets()) {
    EXPECT_LT(InfluenceOf(experiment, redraws).wald, 0.06) << experiment.name;
  }
  for (const Experiment& control : Controls()) {
    EXPECT_GT(InfluenceOf(control, redraws).wald, 0.15) << control.name << " must fail";
  }
}

}  // namespace
}  // namespace strata
