#include <limits>

#include "cli/lab/measure.h"
#include "worker/sampling/inversion.h"

// The integral of f(x) = 4 x^3 over [0, 1], which is 1, from points of density p(x) = (n + 1) x^n.

namespace strata::lab {
namespace {

double Integrand(double x) { return 4 * x * x * x; }

/// The integral of f^2 / p, less 1: 16 / ((n + 1) (7 - n)) - 1. Infinite from n = 7 on.
double VarianceOf(double n) {
  return n < 7 ? 16 / ((n + 1) * (7 - n)) - 1 : std::numeric_limits<double>::infinity();
}

}  // namespace

absl::StatusOr<Outcome> RunImportance(const Settings& settings) {
  Outcome outcome;
  outcome.records.columns = {"n", "mean", "standard error", kVariance, kTheory, kTime, kEfficiency};
  Plot plot = {.title = "Importance sampling of 4 x^3 with p = (n + 1) x^n",
               .x_label = "n",
               .y_label = "variance of a sample",
               .log_y = true};
  Series measured_series = {"measured", {}}, theory = {"16 / ((n + 1) (7 - n)) - 1", {}, true};
  uint32_t stream = 0;
  for (const float n : {0.0f, 1.0f, 2.0f, 2.5f, 2.9f, 3.0f, 3.1f, 3.5f, 4.0f, 5.0f, 6.0f}) {
    RandomStream random(settings.seed, stream++);
    const Measured measured = Measure(settings.samples, [&] {
      const float x = SamplePower(1 - random.Next(), n);  // Not 0, where f / p is no number.
      return Integrand(x) / PowerPdf(x, n);
    });
    outcome.records.rows.push_back(
        {static_cast<double>(n), measured.Mean(), measured.StandardError(), measured.Variance(),
         VarianceOf(n), measured.seconds, Efficiency(measured.Variance(), measured.seconds)});
    if (n != 3) measured_series.points.emplace_back(n, measured.Variance());
  }
  for (double n = 0; n < 6.3; n += 0.02) {
    if (VarianceOf(n) > 1e-4) theory.points.emplace_back(n, VarianceOf(n));
  }
  plot.series = {theory, measured_series};
  outcome.figure = std::move(plot);
  outcome.caption = "Variance against the exponent of the density; at n = 3 it is zero.";
  outcome.remarks = {
      "At n = 3 the density is f / mu and every sample is the answer: what variance is left is "
      "rounding. The nearer p is to that, the less variance (PBRT 2.2.2).",
      "A density that is small where f is not does harm: n = 6 is as bad as the uniform one, n = "
      "0, and from n = 7 on the variance is infinite."};
  return outcome;
}

}  // namespace strata::lab
