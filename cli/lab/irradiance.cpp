#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <numbers>
#include <string>

#include "cli/lab/measure.h"
#include "worker/math/elementary.h"
#include "worker/sampling/warp.h"

// Irradiance (PBRT 4.2) at a point with its normal along z, under a round lamp of radiance 1 at
// height 1 in whose middle the normal points: the lamp fills a cone, so that the answer is pi sin^2
// of the cone's angle, and every variance a closed form. At 90 degrees it is the whole sky.

namespace strata::lab {
namespace {

struct Lamp {
  double degrees;
  double cosine, sine;
  double radius;  ///< At height 1.

  explicit Lamp(double degrees)
      : degrees(degrees),
        cosine(degrees == 90 ? 0 : std::cos(Radians(degrees))),
        sine(std::sin(Radians(degrees))),
        radius(sine / cosine) {}
  bool IsSky() const { return degrees == 90; }
  double Irradiance() const { return std::numbers::pi * sine * sine; }
  bool Contains(Vec3f w) const { return w.z > cosine; }
};

struct Strategy {
  const char* name;
  double (*estimate)(const Lamp& lamp, Vec2f u);
  double (*second_moment)(const Lamp& lamp);
};

double UniformEstimate(const Lamp& lamp, Vec2f u) {
  const Vec3f w = SampleUniformHemisphere(u);
  return lamp.Contains(w) ? w.z / UniformHemispherePdf() : 0;
}
double UniformSecondMoment(const Lamp& lamp) {
  const double pi = std::numbers::pi;
  return 4 * pi * pi * (1 - lamp.cosine * lamp.cosine * lamp.cosine) / 3;
}

double CosineEstimate(const Lamp& lamp, Vec2f u) {
  const Vec3f w = SampleCosineHemisphere(u);
  return lamp.Contains(w) && w.z > 0 ? w.z / CosineHemispherePdf(w.z) : 0;
}
double CosineSecondMoment(const Lamp& lamp) { return std::numbers::pi * lamp.Irradiance(); }

/// A point of the lamp: area times both cosines over the squared distance.
double AreaEstimate(const Lamp& lamp, Vec2f u) {
  const Vec2f p = SampleConcentricDisk(u);
  const double r2 =
      (static_cast<double>(p.x) * p.x + static_cast<double>(p.y) * p.y) * lamp.radius * lamp.radius;
  const double cosine2 = 1 / (1 + r2);
  const double pdf = ConcentricDiskPdf() / (lamp.radius * lamp.radius);
  return cosine2 * cosine2 / pdf;
}
double AreaSecondMoment(const Lamp& lamp) {
  // The mean of cos^8 over the disk, by r^2 = t: of (1 + t)^-4 over [0, radius^2].
  const double r2 = lamp.radius * lamp.radius, area = std::numbers::pi * r2;
  return area * area * (1 - std::pow(1 + r2, -3)) / (3 * r2);
}

double ConeEstimate(const Lamp& lamp, Vec2f u) {
  const auto reach = static_cast<float>(1 - lamp.cosine);
  return SampleUniformCone(u, reach).z / UniformConePdf(reach);
}
double ConeSecondMoment(const Lamp& lamp) {
  const double solid_angle = 2 * std::numbers::pi * (1 - lamp.cosine);
  return solid_angle * 2 * std::numbers::pi * (1 - lamp.cosine * lamp.cosine * lamp.cosine) / 3;
}

constexpr std::array kStrategies = {
    Strategy{"uniform", UniformEstimate, UniformSecondMoment},
    Strategy{"cosine", CosineEstimate, CosineSecondMoment},
    Strategy{"area", AreaEstimate, AreaSecondMoment},
    Strategy{"solid angle", ConeEstimate, ConeSecondMoment},
};

}  // namespace

absl::StatusOr<Outcome> RunIrradiance(const Settings& settings) {
  Outcome outcome;
  outcome.records.columns = {"half-angle", "sampling", "mean", "truth",
                             kVariance,    kTheory,    kTime,  kEfficiency};
  Plot plot = {.title = "Irradiance under a round lamp",
               .x_label = "half-angle of the lamp in degrees",
               .y_label = "variance of a sample / irradiance^2",
               .log_y = true};
  for (const Strategy& strategy : kStrategies) plot.series.push_back({strategy.name, {}});
  uint32_t stream = 0;
  for (const double degrees : {5.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0, 90.0}) {
    const Lamp lamp(degrees);
    const double truth = lamp.Irradiance();
    for (size_t i = 0; i < kStrategies.size(); ++i) {
      const Strategy& strategy = kStrategies[i];
      if (lamp.IsSky() && strategy.estimate == AreaEstimate) continue;  // It has no area.
      RandomStream random(settings.seed, stream++);
      const Measured measured =
          Measure(settings.samples, [&] { return strategy.estimate(lamp, random.Next2D()); });
      const double theory = std::max(0.0, strategy.second_moment(lamp) - truth * truth);
      outcome.records.rows.push_back({degrees, std::string(strategy.name), measured.Mean(), truth,
                                      measured.Variance(), theory, measured.seconds,
                                      Efficiency(measured.Variance(), measured.seconds)});
      const double relative = measured.Variance() / (truth * truth);
      if (relative > 1e-9) plot.series[i].points.emplace_back(degrees, relative);
    }
  }
  outcome.figure = std::move(plot);
  outcome.caption = "Relative variance against the lamp's size.";
  outcome.remarks = {
      "Small lamps are hardly ever met by directions that do not know of them: at 5 degrees cosine "
      "sampling has millions of times the variance of a point chosen on the lamp.",
      "Under a sky that is the same everywhere the cosine is all there is to sample, and its "
      "variance "
      "is zero. A lamp's area, of which most lies far away when it is large, is then the wrong "
      "measure; its solid angle is better, and differs from the cosine alone."};
  return outcome;
}

}  // namespace strata::lab
