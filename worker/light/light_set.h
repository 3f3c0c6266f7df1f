#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <variant>
#include <vector>

#include "common/status.h"
#include "worker/geometry/geometry.h"
#include "worker/light/delta_lights.h"
#include "worker/light/environment.h"
#include "worker/light/shape_light.h"
#include "worker/light/sphere_light.h"
#include "worker/light/triangle_light.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

// All that emits. Each kind is a plain struct with free inline functions in a header of its own:
//
//   std::optional<LightSample> SampleLi(const X&, Vec3f from, Vec2f u)
//   float PdfLi(const X&, Vec3f from, const EmissionHit&)    emissive surfaces
//   float PdfLi(const X&, Vec3f direction)                   environments
//   Rgb Le(...)                                              what a ray that meets it sees

namespace strata {

using Light = std::variant<TriangleLight, SphereLight, ShapeLight, ConstantEnvironment,
                           ImageEnvironment, PointLight, DistantLight>;

/// The lights of a scene and how one of them is chosen: by its power, and now and then
/// any that shines. Immutable.
class LightSet {
 public:
  /// `geometry` must outlive the set. Errors name the light's place in the scene file.
  static absl::StatusOr<LightSet> Build(const SceneDescription& scene, const Geometry& geometry,
                                        const FileSource& source);

  bool empty() const { return lights_.empty(); }
  const std::vector<Light>& lights() const { return lights_; }

  struct Choice {
    uint32_t light = 0;
    float probability = 0;
    float u = 0;  ///< What is left of the random number, again uniform in [0, 1).
  };
  /// Chooses by the 48-bit number u + 2^-24 u_low, both multiples of 2^-24 in [0, 1), so that
  /// enough bits are left even behind a faint light. The set must not be empty.
  Choice Select(float u, float u_low) const;
  bool SelectNeedsLowBits() const { return lights_.size() > 1; }
  float Probability(uint32_t light) const { return probability_[light]; }

  /// Radiance that leaves emissive surface `light` (SurfacePoint::light) towards `wo`.
  Rgb SurfaceLe(uint32_t light, Vec3f ng, Vec3f wo) const;
  /// Density per solid angle with which Select and SampleLi find a point of surface `light`.
  float SurfacePdf(uint32_t light, Vec3f from, const EmissionHit& hit) const;
  std::optional<LightSample> Sample(uint32_t light, Vec3f from, Vec2f u) const;

  /// Indices of the lights that a ray which leaves the scene sees.
  const std::vector<uint32_t>& environments() const { return environments_; }
  Rgb EnvironmentLe(uint32_t light, Vec3f direction) const;
  float EnvironmentPdf(uint32_t light, Vec3f direction) const;

 private:
  void FindProbabilities(const std::vector<double>& powers);

  std::vector<Light> lights_;  ///< Emissive surfaces first, by SurfacePoint::light.
  std::vector<uint32_t> environments_;
  std::vector<std::unique_ptr<EnvironmentImage>> images_;
  std::vector<double> cdf_;  ///< Upper ends; the last is 1.
  std::vector<float> probability_;
};

inline LightSet::Choice LightSet::Select(float u, float u_low) const {
  if (lights_.size() == 1) return {0, 1, u};
  const double x = u + 0x1p-24 * static_cast<double>(u_low);
  const uint32_t light =
      static_cast<uint32_t>(std::upper_bound(cdf_.begin(), cdf_.end() - 1, x) - cdf_.begin());
  const double low = light == 0 ? 0 : cdf_[light - 1];
  const double rest = (x - low) / (cdf_[light] - low);
  constexpr float kBelowOne = 0x1.fffffep-1f;
  return {light, probability_[light], std::min(static_cast<float>(rest), kBelowOne)};
}

inline Rgb LightSet::SurfaceLe(uint32_t light, Vec3f ng, Vec3f wo) const {
  const Light& l = lights_[light];
  if (const auto* triangle = std::get_if<TriangleLight>(&l)) return Le(*triangle, ng, wo);
  if (const auto* sphere = std::get_if<SphereLight>(&l)) return Le(*sphere, ng, wo);
  return Le(*std::get_if<ShapeLight>(&l), ng, wo);
}

inline float LightSet::SurfacePdf(uint32_t light, Vec3f from, const EmissionHit& hit) const {
  const Light& l = lights_[light];
  if (const auto* triangle = std::get_if<TriangleLight>(&l))
    return probability_[light] * PdfLi(*triangle, from, hit);
  if (const auto* sphere = std::get_if<SphereLight>(&l))
    return probability_[light] * PdfLi(*sphere, from, hit);
  return probability_[light] * PdfLi(*std::get_if<ShapeLight>(&l), from, hit);
}

inline std::optional<LightSample> LightSet::Sample(uint32_t light, Vec3f from, Vec2f u) const {
  return std::visit([&](const auto& l) { return SampleLi(l, from, u); }, lights_[light]);
}

inline Rgb LightSet::EnvironmentLe(uint32_t light, Vec3f direction) const {
  const Light& l = lights_[light];
  if (const auto* constant = std::get_if<ConstantEnvironment>(&l)) return Le(*constant, direction);
  return Le(*std::get_if<ImageEnvironment>(&l), direction);
}

inline float LightSet::EnvironmentPdf(uint32_t light, Vec3f direction) const {
  const Light& l = lights_[light];
  if (const auto* constant = std::get_if<ConstantEnvironment>(&l))
    return probability_[light] * PdfLi(*constant, direction);
  return probability_[light] * PdfLi(*std::get_if<ImageEnvironment>(&l), direction);
}

}  // namespace strata
