#include <absl/strings/str_cat.h>

#include <array>
#include <functional>
#include <string>

#include "cli/lab/measure.h"
#include "worker/sampling/inversion.h"

// Means of n samples of three distributions, and how many of them lie within k of their standard
// deviations, which are known here.

namespace strata::lab {
namespace {

struct Distribution {
  const char* name;
  double mean, variance;
  double (*sample)(float u);
};

constexpr double kRareChance = 0.01;

const std::array kDistributions = {
    Distribution{"uniform", 0.5, 1.0 / 12, [](float u) -> double { return u; }},
    Distribution{"exponential", 1, 1, [](float u) -> double { return SampleExponential(u, 1); }},
    // As a firefly: 100 in one sample of a hundred, else nothing.
    Distribution{"rare", 1, 1 / kRareChance - 1,
                 [](float u) -> double { return u < kRareChance ? 1 / kRareChance : 0; }},
};

constexpr int kSteps = 16;  ///< Of a quarter sigma.

/// The share of means within 0, 1/4, 2/4, ... sigma.
struct Shares {
  std::array<double, kSteps + 1> inside = {};
  Measured means;
};

Shares Count(const Distribution& distribution, int n, const Settings& settings, uint32_t stream) {
  RandomStream random(settings.seed, stream);
  const double sigma = std::sqrt(distribution.variance / n);
  Shares shares;
  shares.means = Measure(settings.samples, [&] {
    double sum = 0;
    for (int i = 0; i < n; ++i) sum += distribution.sample(random.Next());
    const double off = std::fabs(sum / n - distribution.mean) / sigma;
    for (int step = 0; step <= kSteps; ++step) shares.inside[step] += off <= 0.25 * step;
    return sum / n;
  });
  for (double& share : shares.inside) share /= static_cast<double>(settings.samples);
  return shares;
}

double NormalShare(double k) { return std::erf(k / std::sqrt(2.0)); }
double ChebyshevShare(double k) { return std::max(0.0, 1 - 1 / (k * k)); }

}  // namespace

absl::StatusOr<Outcome> RunIntervals(const Settings& settings) {
  Outcome outcome;
  outcome.records.columns = {
      "samples of", "n",     "k",   "within k sigma", "Chebyshev: at least", "normal",
      kVariance,    kTheory, kTime, kEfficiency};
  Plot plot = {.title = "Estimates outside of k sigma",
               .x_label = "k",
               .y_label = "share outside",
               .log_y = true};
  Series chebyshev = {"Chebyshev's bound", {}, true}, normal = {"normal distribution", {}, true};
  for (int step = 4; step <= kSteps; ++step) {
    const double k = 0.25 * step;
    chebyshev.points.emplace_back(k, 1 - ChebyshevShare(k));
    normal.points.emplace_back(k, 1 - NormalShare(k));
  }
  plot.series = {chebyshev, normal};
  uint32_t stream = 0;
  for (const Distribution& distribution : kDistributions) {
    for (const int n : {1, 16, 256}) {
      const Shares shares = Count(distribution, n, settings, stream++);
      for (const int k : {1, 2, 3}) {
        outcome.records.rows.push_back({std::string(distribution.name), static_cast<double>(n),
                                        static_cast<double>(k), shares.inside[4 * k],
                                        ChebyshevShare(k), NormalShare(k), shares.means.Variance(),
                                        distribution.variance / n, shares.means.seconds,
                                        Efficiency(shares.means.Variance(), shares.means.seconds)});
      }
      if (n == 1 && distribution.variance < 1) continue;  // Nothing lies beyond 1.7 sigma.
      Series series = {absl::StrCat(distribution.name, ", n = ", n), {}};
      for (int step = 4; step <= kSteps; ++step) {
        if (shares.inside[step] < 1) {
          series.points.emplace_back(0.25 * step, 1 - shares.inside[step]);
        }
      }
      plot.series.push_back(std::move(series));
    }
  }
  outcome.figure = std::move(plot);
  outcome.caption = "The share of estimates farther than k sigma from the truth.";
  outcome.remarks = {
      "Chebyshev's bound (PBRT 2.1.4) holds for every distribution and is far too wide for most: "
      "at "
      "3 sigma 0.889, where the normal distribution has 0.997.",
      "Means of many samples come near the normal share, those of skewed samples later: of the "
      "rare "
      "ones, 16 are mostly all zero, and 256 still miss at 3 sigma more often than 0.3 %."};
  return outcome;
}

}  // namespace strata::lab
