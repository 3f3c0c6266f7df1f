// How fast the variance of estimates of plain integrals falls with their samples, where theory
// knows the rate: n^-3 but for logarithms for smooth integrands (Owen 1997, "Scrambled Net Variance
// for Integrals of Smooth Functions"), n^-1.5 for an edge across two dimensions (Mitchell 1996,
// "Consequences of Stratified Sampling in Graphics"), n^-1 for independent samples and replicates.
// See docs/convergence.md.

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "bench/slopes_fit.h"
#include "worker/sampling/pattern_sampler.h"
#include "worker/sampling/sampler.h"

namespace strata {
namespace {

/// Of the points of the first two pairs of dimensions.
using Integrand = double (*)(Vec2f a, Vec2f b);

double Smooth(Vec2f a, Vec2f) { return std::exp(a.x + a.y); }
double SlantedEdge(Vec2f a, Vec2f) { return 0.81 * a.x + 0.59 * a.y < 0.667; }
double Disk(Vec2f a, Vec2f) {
  const double x = a.x - 0.47, y = a.y - 0.52;
  return x * x + y * y < 0.1;
}
double StraightEdge(Vec2f a, Vec2f) { return a.x < 0.3717; }
double SmoothOverPairs(Vec2f a, Vec2f b) { return std::exp(a.x + a.y + b.x + b.y); }

/// What a curve's samples consist of.
enum class Growth {
  kBySamples,    ///< One replicate of 4, 8, ... 4096 samples.
  kByReplicates  ///< 1, 2, ... 256 replicates of 16 samples.
};
constexpr uint32_t kFixedLength = 16;

struct Curve {
  std::string integrand;
  Integrand function;
  SamplerKind sampler;
  Growth growth;
  double least, most;  ///< The slopes that are asked for; NaN: none.
};

std::vector<Curve> Curves() {
  constexpr auto kSobol = SamplerKind::kSobol, kIndependent = SamplerKind::kIndependent;
  constexpr auto kLength = Growth::kBySamples, kNumber = Growth::kByReplicates;
  std::vector<Curve> curves = {
      {"smooth 2-D", Smooth, kIndependent, kLength, -1.03, -0.97},
      {"slanted edge 2-D", SlantedEdge, kIndependent, kLength, -1.03, -0.97},
      {"slanted edge 2-D", SlantedEdge, kSobol, kLength, -1.6, -1.4},
      {"disk 2-D", Disk, kSobol, kLength, -1.6, -1.4},
      {"smooth 2-D", Smooth, kSobol, kLength, -INFINITY, -2.5},
      {"slanted edge 2-D", SlantedEdge, kSobol, kNumber, -1.03, -0.97},
      {"smooth 2-D", Smooth, kSobol, kNumber, -1.03, -0.97},
      {"straight edge", StraightEdge, kSobol, kLength, NAN, NAN},
      {"smooth 2 x 2-D", SmoothOverPairs, kSobol, kLength, NAN, NAN},
  };
  // Those of blocks of 16 are as good as their blocks, however many. The bare Halton sequence has
  // no variance.
  for (const SamplerKind sampler :
       {SamplerKind::kHalton, SamplerKind::kStratified, SamplerKind::kLatinHypercube,
        SamplerKind::kPoissonDisk, SamplerKind::kDrand48}) {
    const bool no_blocks = sampler == SamplerKind::kHalton || sampler == SamplerKind::kDrand48;
    const double most = sampler == SamplerKind::kHalton ? NAN : -0.97;
    curves.push_back({"smooth 2-D", Smooth, sampler, no_blocks ? kLength : kNumber, -1.03, most});
    curves.push_back(
        {"slanted edge 2-D", SlantedEdge, sampler, no_blocks ? kLength : kNumber, -1.03, most});
    curves.push_back(
        {"smooth 2 x 2-D", SmoothOverPairs, sampler, no_blocks ? kLength : kNumber, -1.03, most});
  }
  return curves;
}

/// An estimate's samples, and the variance of many such estimates.
struct Point {
  uint32_t samples;
  double variance;
};

template <typename Sampler>
double ReplicateMean(Integrand function, const SampleKey& key, uint32_t samples) {
  Sampler sampler(key);
  double sum = 0;
  for (uint32_t i = 0; i < samples; ++i) {
    sampler.StartSample(i);
    sum += function(sampler.Get2D(kPairFilm), sampler.Get2D(kPairLens));
  }
  return sum / samples;
}

/// `key` must differ from point to point; repetitions and replicates have keys of their own.
template <typename Sampler>
double VarianceOfEstimates(Integrand function, SampleKey key, uint32_t length, uint32_t replicates,
                           uint32_t repetitions) {
  double mean = 0, squares = 0;
  for (uint32_t i = 0; i < repetitions; ++i) {  // Welford's update.
    double estimate = 0;
    key.x = i;
    for (key.replicate = 0; key.replicate < replicates; ++key.replicate) {
      estimate += ReplicateMean<Sampler>(function, key, length) / replicates;
    }
    const double deviation = estimate - mean;
    mean += deviation / (i + 1);
    squares += deviation * (estimate - mean);
  }
  return squares / (repetitions - 1);
}

std::vector<Point> Measure(const Curve& curve, SampleKey key, uint32_t repetitions) {
  const bool samples_grow = curve.growth == Growth::kBySamples;
  const auto variance = curve.sampler == SamplerKind::kSobol ? VarianceOfEstimates<SobolSampler>
                        : curve.sampler == SamplerKind::kIndependent
                            ? VarianceOfEstimates<IndependentSampler>
                            : VarianceOfEstimates<PatternSampler>;
  key.kind = curve.sampler;
  std::vector<Point> points;
  for (uint32_t samples = samples_grow ? 4 : kFixedLength; samples <= 4096; samples *= 2) {
    const uint32_t length = samples_grow ? samples : kFixedLength;
    key.y = samples;
    points.push_back(
        {samples, variance(curve.function, key, length, samples / length, repetitions)});
  }
  return points;
}

PowerLaw Fit(const std::vector<Point>& points) {
  std::vector<double> samples, variance;
  for (const Point& p : points) {
    samples.push_back(p.samples);
    variance.push_back(p.variance);
  }
  return FitPowerLaw(samples, variance);
}

std::string_view ToString(Growth growth) {
  return growth == Growth::kBySamples ? "samples" : "replicates";
}

std::string Asked(const Curve& curve) {
  if (std::isnan(curve.most)) return "-";
  char text[32];
  if (std::isinf(curve.least)) {
    std::snprintf(text, sizeof text, "<= %.2f", curve.most);
  } else {
    std::snprintf(text, sizeof text, "%.2f +- %.2f", 0.5 * (curve.least + curve.most),
                  0.5 * (curve.most - curve.least));
  }
  return text;
}

const char* Verdict(const Curve& curve, double slope) {
  if (std::isnan(curve.most)) return "";
  return slope >= curve.least && slope <= curve.most ? "as asked" : "NOT AS ASKED";
}

int Main(int argc, char** argv) {
  CLI::App app("Slopes of the variance of plain integrals, fitted by least squares of logarithms");
  uint32_t repetitions = 4096;
  uint64_t seed = 1;
  std::string csv_path;
  app.add_option("--repetitions", repetitions, "estimates for each point")
      ->check(CLI::Range(1024, 1 << 20));
  app.add_option("--seed", seed);
  app.add_option("--csv", csv_path, "file to write all points to");
  CLI11_PARSE(app, argc, argv);

  std::ofstream csv(csv_path);
  if (!csv_path.empty() && !csv) {
    std::fprintf(stderr, "--csv: cannot write %s\n", csv_path.c_str());
    return 2;
  }
  csv << "integrand,sampler,growing,samples,variance\n";
  std::printf("%u repetitions of each point\n", repetitions);
  std::printf("%-17s %-15s %-11s %12s %12s %16s  %s\n", "integrand", "sampler", "growing",
              "var. of 16", "of 4096", "slope", "asked");
  uint32_t number = 0;
  for (const Curve& curve : Curves()) {
    const std::vector<Point> points =
        Measure(curve, {.seed = seed, .frame = number++}, repetitions);
    const PowerLaw law = Fit(points);
    const std::string sampler(ToString(curve.sampler)), growing(ToString(curve.growth));
    const size_t at_16 = curve.growth == Growth::kBySamples ? 2 : 0;
    std::printf("%-17s %-15s %-11s %12.3e %12.3e %7.3f +- %.3f  %-14s %s\n",
                curve.integrand.c_str(), sampler.c_str(), growing.c_str(), points[at_16].variance,
                points.back().variance, law.slope, law.error, Asked(curve).c_str(),
                Verdict(curve, law.slope));
    for (const Point& p : points) {
      csv << curve.integrand << ',' << sampler << ',' << growing << ',' << p.samples << ','
          << p.variance << '\n';
    }
  }
  return 0;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Main(argc, argv); }
