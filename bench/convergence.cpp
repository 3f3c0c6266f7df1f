// Error against samples and against time, for each scene, sampler and allocation, over several
// seeds. See docs/convergence.md.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "bench/calibration_figures.h"
#include "bench/calibration_trials.h"
#include "bench/slopes_fit.h"
#include "bench/stopwatch.h"
#include "worker/integrator/render.h"
#include "worker/scene/scene.h"

namespace strata {
namespace {

struct Method {
  SamplerKind sampler;
  AllocationKind allocation;
  std::string Name() const {
    return std::string(ToString(sampler)) + "," + std::string(ToString(allocation));
  }
};

struct Options {
  std::vector<std::string> scenes;
  std::vector<Method> methods;  ///< The first is what efficiencies are measured against.
  int size = 64;
  uint32_t min_spp = 16, max_spp = 1024;
  uint32_t reference_spp = 16384;
  int seeds = 4;
  int threads = 2;
  bool cpu = false;  ///< Seconds are of user CPU time.
  std::string csv;
};

/// Each sampler with each allocation that it can have.
absl::StatusOr<std::vector<Method>> ParseMethods(const std::vector<std::string>& samplers,
                                                 const std::vector<std::string>& allocations) {
  std::vector<Method> methods;
  for (const std::string& sampler : samplers) {
    for (const std::string& allocation : allocations) {
      Method method;
      STRATA_ASSIGN_OR_RETURN(method.sampler, ParseSamplerKind(sampler));
      STRATA_ASSIGN_OR_RETURN(method.allocation, ParseAllocationKind(allocation));
      if (ClaimsInterval(method.sampler) || method.allocation == AllocationKind::kUniform)
        methods.push_back(method);
    }
  }
  return methods;
}

/// A render, and what rendering alone took: no planning, merging or estimating.
struct TimedTrial {
  Trial trial;
  double seconds = 0, rays = 0;
};

/// A square frame of a scene.
class SceneBench {
 public:
  static absl::StatusOr<SceneBench> Load(const std::string& path, const Options& options) {
    const std::filesystem::path file = std::filesystem::absolute(path).lexically_normal();
    SceneBench bench;
    bench.cpu_ = options.cpu;
    bench.name_ = (file.parent_path().filename() / file.stem()).string();
    const std::string scene = file.filename().string();
    STRATA_ASSIGN_OR_RETURN(bench.scene_, LoadScene(DirectorySource(file.parent_path()), scene));
    JobSpec& spec = bench.spec_;
    spec.bundle = {scene, {{scene, {}, 0}}};
    spec.width = spec.height = options.size;
    spec.crop = {0, 0, options.size, options.size};
    spec.tile = options.size;  // Large units, which threads share well.
    spec.max_depth = bench.scene_->defaults().max_depth;
    spec.filter = bench.scene_->defaults().filter;
    return bench;
  }

  const std::string& name() const { return name_; }

  absl::StatusOr<TimedTrial> Render(const Method& method, uint32_t spp, uint64_t seed,
                                    RenderPool& pool) const {
    JobSpec spec = spec_;
    spec.sampler = method.sampler;
    spec.allocation = method.allocation;
    spec.spp = spp;
    spec.seed = seed;
    STRATA_RETURN_IF_ERROR(ValidateJobSpec(spec));
    STRATA_ASSIGN_OR_RETURN(const auto renderer, Renderer::Create(scene_, spec));
    TimedTrial timed;
    const RenderUnit render = [&](const WorkUnit& unit) {
      const Stopwatch stopwatch(cpu_);
      auto partial = renderer->Render(unit, pool);
      timed.seconds += stopwatch.Seconds();
      if (partial.ok()) {
        for (const uint64_t rays : partial->rays) timed.rays += static_cast<double>(rays);
      }
      return partial;
    };
    const Allocation allocation{std::string(ToString(method.allocation)), method.allocation};
    STRATA_ASSIGN_OR_RETURN(timed.trial, RenderTrial(spec, allocation, render));
    return timed;
  }

 private:
  std::string name_;
  std::shared_ptr<const Scene> scene_;
  JobSpec spec_;
  bool cpu_ = false;
};

/// Means over all channels, each divided by reference^2 + 0.01.
double MeanRelative(const std::vector<double>& reference, const auto& error_squared_of) {
  double sum = 0;
  for (size_t i = 0; i < reference.size(); ++i) {
    sum += error_squared_of(i) / (reference[i] * reference[i] + 0.01);
  }
  return sum / static_cast<double>(reference.size());
}

/// The relMSE of the reference itself, from the spread of its eight replicates.
double OwnRelativeError(const Trial& reference) {
  return MeanRelative(reference.mean, [&](size_t i) { return reference.error_squared[i]; });
}

double RelativeError(const Trial& trial, const Trial& reference) {
  return MeanRelative(reference.mean, [&](size_t i) {
    const double deviation = trial.mean[i] - reference.mean[i];
    return deviation * deviation;
  });
}

/// All seeds of one method at one budget.
struct Seeds {
  std::vector<double> relmse, samples, seconds, rays;

  void Add(const TimedTrial& timed, const Trial& reference, double own_error) {
    double sum = 0;
    for (const uint32_t n : timed.trial.samples) sum += n;
    relmse.push_back(RelativeError(timed.trial, reference) - own_error);
    samples.push_back(sum / static_cast<double>(timed.trial.samples.size()));
    seconds.push_back(timed.seconds);
    rays.push_back(timed.rays);
  }
};

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const size_t n = values.size();
  return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

/// One point of a curve.
struct Point {
  uint32_t spp;          ///< Asked for.
  double samples;        ///< Taken for each pixel: the mean over pixels and seeds.
  MeanAndError relmse;   ///< Over seeds.
  double seconds, rays;  ///< Medians over seeds.
  double spread;         ///< Of the seconds: half of their range, over the median.
  double Efficiency() const { return 1 / (relmse.mean * seconds); }
};
using Curve = std::vector<Point>;

Point PointOf(uint32_t spp, const Seeds& seeds) {
  const auto [least, most] = std::minmax_element(seeds.seconds.begin(), seeds.seconds.end());
  const double seconds = Median(seeds.seconds);
  return {spp,     MeanOf(seeds.samples).mean, MeanOf(seeds.relmse),
          seconds, Median(seeds.rays),         0.5 * (*most - *least) / seconds};
}

/// The curves of all methods. Methods take turns, so that what else the machine does meets all.
/// Below 64 samples an allocation has no second round: the curves of ring and greedy begin there.
absl::StatusOr<std::vector<Curve>> Measure(const SceneBench& scene, const Trial& reference,
                                           double own_error, const Options& options,
                                           RenderPool& pool) {
  const std::vector<Method>& methods = options.methods;
  std::vector<Curve> curves(methods.size());
  for (uint32_t spp = options.min_spp; spp <= options.max_spp; spp *= 2) {
    std::vector<Seeds> seeds(methods.size());
    for (int i = 0; i < options.seeds; ++i) {
      for (size_t m = 0; m < methods.size(); ++m) {
        if (methods[m].allocation != AllocationKind::kUniform && spp < 64) continue;
        STRATA_ASSIGN_OR_RETURN(const TimedTrial timed,
                                scene.Render(methods[m], spp, static_cast<uint64_t>(i) + 1, pool));
        seeds[m].Add(timed, reference, own_error);
      }
    }
    for (size_t m = 0; m < methods.size(); ++m) {
      if (!seeds[m].relmse.empty()) curves[m].push_back(PointOf(spp, seeds[m]));
    }
  }
  return curves;
}

PowerLaw FitOver(double Point::*abscissa, const Curve& curve) {
  std::vector<double> x, y;
  for (const Point& point : curve) {
    x.push_back(point.*abscissa);
    y.push_back(point.relmse.mean);
  }
  return FitPowerLaw(x, y);
}

void Print(const std::string& scene, const std::vector<Method>& methods,
           const std::vector<Curve>& curves, std::ofstream& csv) {
  const Point& baseline = curves.front().back();
  for (size_t m = 0; m < curves.size(); ++m) {
    const Curve& curve = curves[m];
    const Point& last = curve.back();
    const PowerLaw by_samples = FitOver(&Point::samples, curve);
    const PowerLaw by_seconds = FitOver(&Point::seconds, curve);
    std::printf(
        "%-24s %-23s %6.1f %10.3e +- %2.0f %% %7.2f +- %2.0f %% %6.2f +- %.2f %6.2f +- %.2f "
        "%8.2f\n",
        scene.c_str(), methods[m].Name().c_str(), last.samples, last.relmse.mean,
        100 * last.relmse.error / last.relmse.mean, last.seconds, 100 * last.spread,
        by_samples.slope, by_samples.error, by_seconds.slope, by_seconds.error,
        last.Efficiency() / baseline.Efficiency());
    for (const Point& p : curve) {
      csv << scene << ',' << methods[m].Name() << ',' << p.spp << ',' << p.samples << ','
          << p.relmse.mean << ',' << p.relmse.error << ',' << p.seconds << ',' << p.rays << ','
          << p.Efficiency() << ',' << p.spread << std::endl;
    }
  }
  std::fflush(stdout);
}

absl::Status Run(const Options& options) {
  if (options.min_spp > options.max_spp / 4 || options.max_spp < 256) {
    return absl::InvalidArgumentError(
        "--min-spp, --max-spp: slopes want three points or more from 64 spp on; give a maximum of "
        "256 or more and a minimum of at most a quarter of it");
  }
  RenderPool pool(options.threads);
  std::ofstream csv(options.csv);
  if (!options.csv.empty() && !csv) {
    return absl::InvalidArgumentError("--csv: cannot write " + options.csv);
  }
  csv << "scene,sampler,allocation,spp,samples,relmse,relmse_stderr,seconds,rays,efficiency,"
         "seconds_spread\n";
  std::printf(
      "%dx%d, %d threads, %d seeds, references of %u spp; at the last point: samples, "
      "relMSE, %s, and efficiency over the first line's\n",
      options.size, options.size, options.threads, options.seeds, options.reference_spp,
      options.cpu ? "seconds of user CPU time" : "seconds");
  std::printf("%-24s %-23s %6s %18s %13s %15s %15s %10s\n", "scene", "sampler,allocation", "spp",
              "relMSE", "s", "slope (spp)", "slope (s)", "efficiency");
  for (const std::string& path : options.scenes) {
    STRATA_ASSIGN_OR_RETURN(const SceneBench scene, SceneBench::Load(path, options));
    // Seed 0 is the reference's; the curves' begin at 1.
    STRATA_ASSIGN_OR_RETURN(const TimedTrial reference,
                            scene.Render({SamplerKind::kSobol, AllocationKind::kUniform},
                                         options.reference_spp, 0, pool));
    const double own_error = OwnRelativeError(reference.trial);
    std::printf("%-24s %-23s %6u %10.3e %14.2f\n", scene.name().c_str(), "reference, subtracted",
                options.reference_spp, own_error, reference.seconds);
    STRATA_ASSIGN_OR_RETURN(const std::vector<Curve> curves,
                            Measure(scene, reference.trial, own_error, options, pool));
    Print(scene.name(), options.methods, curves, csv);
  }
  return absl::OkStatus();
}

int Main(int argc, char** argv) {
  CLI::App app("Error against samples and time: relMSE, slopes, efficiency 1 / (relMSE x seconds)");
  Options options;
  app.add_option("scenes", options.scenes, "pbrt files")->required();
  app.add_option("--size", options.size, "edge of the square frame in pixels")
      ->check(CLI::Range(32, 1024));
  app.add_option("--min-spp", options.min_spp, "first point; doubled from point to point");
  app.add_option("--max-spp", options.max_spp, "last point");
  app.add_option("--reference-spp", options.reference_spp, "Sobol' samples of the reference");
  std::vector<std::string> samplers = {"independent", "sobol"};
  std::vector<std::string> allocations = {"uniform", "ring", "greedy"};
  app.add_option("--samplers", samplers, "names; the first is the baseline")->delimiter(',');
  app.add_option("--allocations", allocations, "of each sampler")->delimiter(',');
  app.add_option("--seeds", options.seeds, "renders of each point")->check(CLI::Range(2, 1000));
  app.add_option("--threads", options.threads)->check(CLI::Range(1, 1024));
  app.add_flag("--cpu", options.cpu, "seconds are of user CPU time");
  app.add_option("--csv", options.csv, "file to write all points to");
  CLI11_PARSE(app, argc, argv);
  absl::Status status;
  if (auto methods = ParseMethods(samplers, allocations); methods.ok()) {
    options.methods = *std::move(methods);
    status = Run(options);
  } else {
    status = methods.status();
  }
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return 2;
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) { return strata::Main(argc, argv); }
