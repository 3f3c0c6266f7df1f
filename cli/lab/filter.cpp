#include <array>
#include <functional>
#include <string>

#include "cli/lab/measure.h"
#include "worker/sampling/filter.h"

// One pixel of a line, at 0, near an edge: the picture is 2 right of 0.3 and 1 left of it. The
// pixel is the integral of the picture times the normalised filter (PBRT 8.8).

namespace strata::lab {
namespace {

constexpr double kEdge = 0.3;

double Picture1D(double x) { return x > kEdge ? 2 : 1; }

struct Pixel {
  FilterAxis filter;
  double radius;
  double truth;
};

Pixel MakePixel(FilterKind kind) {
  const FilterSpec spec = DefaultFilter(kind);
  // 1, and what the right side adds.
  Pixel pixel = {FilterAxis(kind, spec.radius_x, spec), spec.radius_x, 1};
  constexpr int kSteps = 20000;
  const double width = (pixel.radius - kEdge) / kSteps;
  for (int i = 0; i < kSteps; ++i) {
    pixel.truth += width * pixel.filter.Eval(static_cast<float>(kEdge + (i + 0.5) * width));
  }
  return pixel;
}

/// Where a sample lies in the filter's support, uniformly, and what the filter is there.
struct Splat {
  double x, weight;
};
Splat NextSplat(const Pixel& pixel, RandomStream& random) {
  const auto x = static_cast<float>((2 * random.Next() - 1) * pixel.radius);
  return {x, pixel.filter.Eval(x)};
}

/// sum(w f) / sum(w), the usual way: a ratio of two estimates.
double WeightedAverage(const Pixel& pixel, int n, RandomStream& random) {
  double sum = 0, weights = 0;
  for (int i = 0; i < n; ++i) {
    const Splat splat = NextSplat(pixel, random);
    sum += splat.weight * Picture1D(splat.x);
    weights += splat.weight;
  }
  return weights != 0 ? sum / weights : 0;
}

/// The same samples over the density they were drawn with.
double WeightedSum(const Pixel& pixel, int n, RandomStream& random) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const Splat splat = NextSplat(pixel, random);
    sum += splat.weight * Picture1D(splat.x);
  }
  return 2 * pixel.radius * sum / n;
}

double ImportanceSampled(const Pixel& pixel, int n, RandomStream& random) {
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    const FilterAxis::Point point = pixel.filter.Sample(random.Next());
    sum += point.weight * Picture1D(point.offset);
  }
  return sum / n;
}

struct Estimator {
  const char* name;
  double (*estimate)(const Pixel& pixel, int n, RandomStream& random);
};
constexpr std::array kEstimators = {
    Estimator{"weighted average", WeightedAverage},
    Estimator{"weighted sum", WeightedSum},
    Estimator{"importance sampled", ImportanceSampled},
};

}  // namespace

absl::StatusOr<Outcome> RunFilter(const Settings& settings) {
  Outcome outcome;
  outcome.records.columns = {"filter",  "estimator", "n",   "bias",     "its error",
                             kVariance, "MSE",       kTime, kEfficiency};
  Plot plot = {.title = "Bias of a pixel at an edge",
               .x_label = "samples",
               .y_label = "|bias|",
               .log_x = true,
               .log_y = true};
  uint32_t stream = 0;
  for (const FilterKind kind : {FilterKind::kGaussian, FilterKind::kMitchell}) {
    const Pixel pixel = MakePixel(kind);
    const std::string filter(ToString(kind));
    for (const Estimator& estimator : kEstimators) {
      Series series = {filter + ", " + estimator.name, {}};
      for (const int n : {1, 4, 16, 64}) {
        RandomStream random(settings.seed, stream++);
        const Measured measured =
            Measure(settings.samples, [&] { return estimator.estimate(pixel, n, random); });
        const double bias = measured.Mean() - pixel.truth;
        outcome.records.rows.push_back({filter, std::string(estimator.name), static_cast<double>(n),
                                        bias, measured.StandardError(), measured.Variance(),
                                        measured.Variance() + bias * bias, measured.seconds,
                                        Efficiency(measured.Variance(), measured.seconds)});
        // What does not stand out of the noise is no bias to draw.
        if (std::fabs(bias) > 3 * measured.StandardError()) {
          series.points.emplace_back(n, std::fabs(bias));
        }
      }
      if (!series.points.empty()) plot.series.push_back(std::move(series));
    }
  }
  plot.series.push_back({"0.1 / n", {{1, 0.1}, {64, 0.1 / 64}}, true});
  outcome.figure = std::move(plot);
  outcome.caption = "Biases that are more than three standard errors, against the samples.";
  outcome.remarks = {
      "The weighted average sum(w f) / sum(w) is a ratio of estimates: its bias falls as 1 / n. "
      "With "
      "one sample it knows nothing of the filter but its width. Where weights may be negative "
      "(mitchell) their sum may come near 0, and the variance is anything.",
      "The other two are unbiased. The weighted sum pays with variance: samples count that the "
      "filter hardly weighs. Filter importance sampling (PBRT 8.8.2) draws them in proportion to "
      "the "
      "filter, all weights are +-1 but for a factor, and a pixel owns its samples: what the "
      "renderer "
      "does."};
  return outcome;
}

}  // namespace strata::lab
