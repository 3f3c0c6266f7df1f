#include <algorithm>
#include <array>
#include <chrono>
#include <numbers>
#include <string>

#include "cli/lab/grid_rules.h"
#include "cli/lab/measure.h"

// The product over all axes of 1 / (ln 2 (1 + x)), whose integral over the cube is 1. It is smooth
// and not periodic, so that no rule has luck with it.

namespace strata::lab {
namespace {

constexpr int kMaxDimensions = 8;
constexpr int kRuns = 32;  ///< Of each random method: its error is a root mean square.
/// Below this the error of a rule is rounding.
constexpr double kRounding = 1e-11;

using Point = std::array<double, kMaxDimensions>;

double Integrand(const Point& x, int dimensions) {
  double product = 1;
  for (int i = 0; i < dimensions; ++i) product *= 1 / (std::numbers::ln2 * (1 + x[i]));
  return product;
}

/// Of one sample: the integral of the square is (1 / (2 ln^2 2))^d.
double SampleVariance(int dimensions) {
  return std::pow(0.5 / (std::numbers::ln2 * std::numbers::ln2), dimensions) - 1;
}

/// The sum over the grid of one rule on all axes.
double GridSum(const GridRule& rule, int dimensions) {
  const int n = static_cast<int>(rule.nodes.size());
  std::array<int, kMaxDimensions> index = {};
  double sum = 0;
  while (true) {
    Point x;
    double weight = 1;
    for (int i = 0; i < dimensions; ++i) {
      x[i] = rule.nodes[index[i]];
      weight *= rule.weights[index[i]];
    }
    sum += weight * Integrand(x, dimensions);
    int axis = 0;
    while (axis < dimensions && ++index[axis] == n) index[axis++] = 0;
    if (axis == dimensions) return sum;
  }
}

/// One method at one number of evaluations.
struct Run {
  double evaluations = 0, error = 0;  ///< The latter root mean square, where it is random.
  double variance = 0, seconds = 0;
};

Run RunGrid(RuleKind kind, int dimensions, int intervals) {
  const GridRule rule = MakeRule(kind, intervals);
  const auto start = std::chrono::steady_clock::now();
  const double error = std::fabs(GridSum(rule, dimensions) - 1);
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
  return {std::pow(rule.nodes.size(), dimensions), error, error * error, passed.count()};
}

/// The mean over one replicate of the sampler.
template <typename Sampler>
double SampleMean(const SampleKey& key, int dimensions, int64_t evaluations) {
  Sampler sampler(key);
  double sum = 0;
  for (int64_t i = 0; i < evaluations; ++i) {
    sampler.StartSample(static_cast<uint32_t>(i));
    Point x;
    for (int axis = 0; axis < dimensions; axis += 2) {
      const Vec2f u = sampler.Get2D(static_cast<uint32_t>(axis / 2));
      x[axis] = u.x;
      if (axis + 1 < dimensions) x[axis + 1] = u.y;
    }
    sum += Integrand(x, dimensions);
  }
  return sum / static_cast<double>(evaluations);
}

template <typename Sampler>
Run RunRandom(uint64_t seed, int dimensions, int64_t evaluations) {
  uint32_t replicate = 0;
  double squares = 0;
  const Measured measured = Measure(kRuns, [&] {
    const SampleKey key = {
        .seed = seed, .x = static_cast<uint32_t>(dimensions), .replicate = replicate++};
    const double mean = SampleMean<Sampler>(key, dimensions, evaluations);
    squares += (mean - 1) * (mean - 1) / kRuns;
    return mean;
  });
  return {static_cast<double>(evaluations), std::sqrt(squares), measured.Variance(),
          measured.seconds};
}

double Order(const Run& coarse, const Run& fine) {
  return std::log(coarse.error / fine.error) / std::log(fine.evaluations / coarse.evaluations);
}

/// The order from the finest grids that are half of each other and above rounding.
double GridOrder(RuleKind kind, int dimensions, int intervals) {
  const int step = kind == RuleKind::kSimpson ? 4 : 2;
  for (int fine = intervals / step * step; fine >= step; fine = fine / 2 / step * step) {
    const Run run = RunGrid(kind, dimensions, fine);
    if (run.error > kRounding) return Order(RunGrid(kind, dimensions, fine / 2), run);
  }
  return kNone;
}

void AddRow(Outcome& outcome, int dimensions, const std::string& rule, const Run& run, double order,
            double expected, double theory) {
  outcome.records.rows.push_back({static_cast<double>(dimensions), rule, run.evaluations, run.error,
                                  order, expected, run.variance, theory, run.seconds,
                                  Efficiency(run.variance, run.seconds, kRounding * kRounding)});
  auto& series = std::get<Plot>(outcome.figure).series;
  const auto of_rule =
      std::find_if(series.begin(), series.end(), [&](const Series& s) { return s.name == rule; });
  Series& points = of_rule != series.end() ? *of_rule : series.emplace_back(Series{rule, {}});
  points.points.emplace_back(dimensions, std::max(run.error, 1e-16));
}

}  // namespace

absl::StatusOr<Outcome> RunQuadrature(const Settings& settings) {
  Outcome outcome;
  outcome.records.columns = {"dimensions", "rule",    "evaluations", "error", "order",
                             "in theory",  kVariance, kTheory,       kTime,   kEfficiency};
  outcome.figure = Plot{.title = "Error of about as many evaluations",
                        .x_label = "dimensions",
                        .y_label = "error",
                        .log_y = true};
  outcome.caption = "The error that each rule reaches with about the same number of evaluations.";
  const auto evaluations = static_cast<double>(settings.samples);
  // From a 64th of them, so that the random errors of both ends hardly move the slope.
  const int64_t few = std::max<int64_t>(settings.samples / 64, 2);
  for (int d = 1; d <= kMaxDimensions; ++d) {
    for (const RuleKind kind :
         {RuleKind::kRectangle, RuleKind::kTrapezoid, RuleKind::kSimpson, RuleKind::kGauss}) {
      const int intervals = MostIntervals(kind, d, evaluations);
      if (intervals == 0) continue;
      const bool power = kind != RuleKind::kGauss;
      AddRow(outcome, d, std::string(ToString(kind)), RunGrid(kind, d, intervals),
             power ? GridOrder(kind, d, intervals) : kNone, OrderOf(kind, d), kNone);
    }
    const Run random = RunRandom<IndependentSampler>(settings.seed, d, settings.samples);
    AddRow(outcome, d, "Monte Carlo", random,
           Order(RunRandom<IndependentSampler>(settings.seed + 1, d, few), random), 0.5,
           SampleVariance(d) / evaluations);
    const Run sobol = RunRandom<SobolSampler>(settings.seed, d, settings.samples);
    AddRow(outcome, d, "Sobol'", sobol,
           Order(RunRandom<SobolSampler>(settings.seed + 1, d, few), sobol), kNone, kNone);
  }
  outcome.remarks = {
      "The error of a rule of order k falls as n^(-k/d): d dimensions share the evaluations. That "
      "of "
      "Monte Carlo falls as n^(-1/2) in any. With these evaluations the rectangle rule falls "
      "behind it "
      "from two dimensions on, the trapezoid rule from four, Simpson's from seven. Gauss-Legendre "
      "stays ahead for as long as the integrand is as smooth as this one.",
      "Orders are those of the finest grids above rounding; errors of random methods are root mean "
      "squares over 32 runs. V of a rule is its squared error: the next run would err by as much.",
      "Sobol' points are the renderer's: pairs of dimensions, scrambled and shuffled each on its "
      "own "
      "(PBRT 8.7). Within a pair the error falls faster than between pairs, where it falls as 1 / "
      "sqrt(n)."};
  return outcome;
}

}  // namespace strata::lab
