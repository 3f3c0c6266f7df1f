#include "worker/light/light_set.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include "worker/math/vec3d.h"

namespace strata {
namespace {

constexpr double kPiDouble = std::numbers::pi;

Light SurfaceLight(const Emitter& emitter, const Geometry& geometry) {
  if (const auto* triangle = std::get_if<TriangleEmitter>(&emitter.shape)) {
    const Vec3f bound = Abs(triangle->p0) + Abs(triangle->p1) + Abs(triangle->p2);
    constexpr float kRounding = 6 * 0x1p-24f;  // gamma(6) of PBRT 6.8.1.
    return TriangleLight{triangle->p0,
                         triangle->p1 - triangle->p0,
                         triangle->p2 - triangle->p0,
                         triangle->ng,
                         bound * kRounding,
                         1 / emitter.area,
                         emitter.radiance,
                         emitter.two_sided};
  }
  if (const auto* sphere = std::get_if<SphereEmitter>(&emitter.shape))
    return SphereLight{sphere->center, sphere->radius, sphere->inward, emitter.radiance,
                       emitter.two_sided};
  return ShapeLight{&geometry, std::get<OtherEmitter>(emitter.shape), emitter.radiance,
                    emitter.two_sided};
}

double Power(const Emitter& emitter) {
  return kPiDouble * emitter.area * Luminance(emitter.radiance) * (emitter.two_sided ? 2 : 1);
}

/// The power that light from afar brings to a ball around the scene.
double PowerFromAfar(double irradiance_sum, double scene_radius) {
  return kPiDouble * scene_radius * scene_radius * irradiance_sum;
}

/// The part of the choices that does not go by power. A lamp may be hidden by a wall from what
/// faint ones light, whose noise then stays bounded (defensive sampling: Hesterberg 1995).
constexpr double kEvenShare = 0.01;

double SceneRadius(const Geometry& geometry) {
  const Geometry::Bounds bounds = geometry.bounds();
  const Vec3f diagonal = bounds.max - bounds.min;
  const double radius = 0.5 * Length(diagonal);
  return std::isfinite(radius) && radius > 0 ? radius : 1;  // Nothing to light: any will do.
}

}  // namespace

absl::StatusOr<LightSet> LightSet::Build(const SceneDescription& scene, const Geometry& geometry,
                                         const FileSource& source) {
  LightSet set;
  std::vector<double> powers;
  for (const Emitter& emitter : geometry.emitters()) {
    set.lights_.push_back(SurfaceLight(emitter, geometry));
    powers.push_back(Power(emitter));
  }
  const double radius = SceneRadius(geometry);
  for (const LightDescription& description : scene.lights) {
    if (const auto* point = std::get_if<PointLightDescription>(&description.light)) {
      set.lights_.push_back(PointLight{ToFloat(point->position), point->intensity});
      powers.push_back(4 * kPiDouble * Luminance(point->intensity));
    } else if (const auto* distant = std::get_if<DistantLightDescription>(&description.light)) {
      set.lights_.push_back(DistantLight{distant->direction, distant->irradiance});
      powers.push_back(PowerFromAfar(Luminance(distant->irradiance), radius));
    } else {
      Rgb mean;
      set.environments_.push_back(static_cast<uint32_t>(set.lights_.size()));
      if (const auto* image = std::get_if<ImageInfiniteLightDescription>(&description.light)) {
        auto loaded = EnvironmentImage::Load(*image, source);
        if (!loaded.ok()) return Annotate(loaded.status(), description.where.ToString());
        set.images_.push_back(std::make_unique<EnvironmentImage>(*std::move(loaded)));
        set.lights_.push_back(ImageEnvironment{set.images_.back().get()});
        mean = set.images_.back()->mean;
      } else {
        mean = std::get<ConstantInfiniteLightDescription>(description.light).radiance;
        set.lights_.push_back(ConstantEnvironment{mean});
      }
      powers.push_back(PowerFromAfar(4 * kPiDouble * Luminance(mean), radius));
    }
  }
  set.FindProbabilities(powers);
  return set;
}

void LightSet::FindProbabilities(const std::vector<double>& powers) {
  const double total = std::accumulate(powers.begin(), powers.end(), 0.0);
  // Where no power is known (all black, or beyond all numbers) every light is as good as another.
  const bool by_power = total > 0 && std::isfinite(total);
  const auto lit = std::count_if(powers.begin(), powers.end(), [](double p) { return p > 0; });
  const double even = 1.0 / static_cast<double>(by_power ? lit : powers.size());
  double sum = 0;
  for (double power : powers) {
    const double before = sum;
    if (!by_power)
      sum += even;
    else if (power > 0)
      sum += (1 - kEvenShare) * power / total + kEvenShare * even;
    cdf_.push_back(sum);
    probability_.push_back(static_cast<float>(sum - before));
  }
  // Rounding must not leave a gap behind the last light that may be chosen.
  for (size_t i = cdf_.size(); i-- > 0;) {
    cdf_[i] = 1;
    if (probability_[i] > 0) break;
  }
}

}  // namespace strata
