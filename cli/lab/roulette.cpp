#include <array>
#include <string>

#include "cli/lab/measure.h"
#include "worker/sampling/inversion.h"
#include "worker/sampling/roulette.h"

// An estimate of two parts: A, cheap, of mean and variance 1; and w times F, of mean 1, that takes
// 64 times the work, as a path takes that goes on for long. Roulette plays for F alone.

namespace strata::lab {
namespace {

constexpr int kWork = 64;  ///< Samples whose mean F is.
constexpr double kVarianceOfA = 1, kVarianceOfF = 1.0 / kWork;

double Exponential(RandomStream& random) { return SampleExponential(random.Next(), 1); }

double CostlyPart(RandomStream& random) {
  double sum = 0;
  for (int i = 0; i < kWork; ++i) sum += Exponential(random);
  return sum / kWork;
}

}  // namespace

absl::StatusOr<Outcome> RunRoulette(const Settings& settings) {
  Outcome outcome;
  outcome.records.columns = {"weight of F", "c",     "q",   "mean",     "truth",
                             kVariance,     kTheory, kTime, kEfficiency};
  Plot plot = {.title = "Efficiency with roulette",
               .x_label = "q, the probability of leaving F out",
               .y_label = "efficiency / that without roulette",
               .log_y = true};
  uint32_t stream = 0;
  for (const double weight : {0.02, 1.0}) {
    for (const bool at_mean : {false, true}) {
      Series series = {ToText(weight) + " F, c = " + (at_mean ? "mean" : "0"), {}};
      double without = 0;
      for (const float q : {0.0f, 0.25f, 0.5f, 0.75f, 0.9f, 0.97f}) {
        const Roulette<double> roulette = {q, at_mean ? weight : 0};
        RandomStream random(settings.seed, stream++);
        const Measured measured = Measure(settings.samples, [&] {
          const double a = Exponential(random);
          return a + (roulette.Ends(random.Next())
                          ? roulette.c
                          : roulette.Survivor(weight * CostlyPart(random)));
        });
        const double theory =
            kVarianceOfA + RouletteVariance(weight, weight * weight * kVarianceOfF, q, roulette.c);
        const double efficiency = Efficiency(measured.Variance(), measured.seconds);
        if (q == 0) without = efficiency;
        outcome.records.rows.push_back({weight, roulette.c, static_cast<double>(q), measured.Mean(),
                                        1 + weight, measured.Variance(), theory, measured.seconds,
                                        efficiency});
        series.points.emplace_back(q, efficiency / without);
      }
      plot.series.push_back(std::move(series));
    }
  }
  outcome.figure = std::move(plot);
  outcome.caption = "Efficiency against q, relative to q = 0.";
  outcome.remarks = {
      "F' = (F - q c) / (1 - q), or c with probability q, has the mean of F and more variance "
      "(PBRT 2.2.4): roulette pays by the time it saves. It does where the part it plays for is "
      "costly and matters little.",
      "Where F matters as much as the rest, the variance that a large q adds eats up the time "
      "saved, unless c is near the mean of F: then what is lost is next to nothing."};
  return outcome;
}

}  // namespace strata::lab
