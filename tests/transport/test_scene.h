#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/job.h"
#include "worker/integrator/render.h"
#include "worker/scene/description.h"
#include "worker/scene/scene.h"

// Small scenes built in code, their renders, and what statistics say of them.

namespace strata {

/// Builds a description step by step. Space: y up.
class TestScene {
 public:
  TestScene();

  TextureId Texture(Rgb value);
  MaterialId Material(const MaterialDescription& material);
  MaterialId Diffuse(float reflectance);
  MaterialId Diffuse(Rgb reflectance);

  /// The emission of a sphere leaves its outside, or its inside if `reverse`.
  void Sphere(Vec3f center, float radius, MaterialId material,
              std::optional<AreaEmission> emission = std::nullopt, bool reverse = false);
  /// A flat polygon, counter-clockwise as seen from the side its normal points to.
  void Polygon(const std::vector<Vec3f>& corners, MaterialId material,
               std::optional<AreaEmission> emission = std::nullopt);
  void Light(decltype(LightDescription::light) light);
  void Camera(Vec3f eye, Vec3f look, float fov);

  SceneDescription description;
};

AreaEmission Emits(float radiance, bool two_sided = false);

/// A square frame with the box filter and the default sampler.
JobSpec TestSpec(int size, uint32_t spp, int max_depth);

/// `source` holds the scene's images.
std::shared_ptr<const Scene> BuildScene(const TestScene& scene,
                                        const FileSource& source = DirectorySource("."),
                                        const BuildOptions& lights = {});

/// A frame rendered as one unit; the second by a strategy, whatever `spec` says.
Partial RenderFrame(std::shared_ptr<const Scene> scene, const JobSpec& spec);
Partial RenderFrame(std::shared_ptr<const Scene> scene, JobSpec spec, DirectStrategy strategy);

/// A mean with its standard error, which has so many degrees of freedom (7 for each pixel) that it
/// may be taken as normal.
struct Estimate {
  double mean = 0, standard_error = 0;
};

/// Of one colour (0, 1, 2) over all pixels.
Estimate FrameMean(const Partial& partial, int channel);
/// Of one pixel, by index; pools nothing, so the standard error has 7 degrees of freedom alone.
double PixelMean(const Partial& partial, int64_t pixel, int channel);

/// Two-sided tests are made at p = 1e-5 each: with some hundred checks in this folder, and fixed
/// seeds, a failure means a defect.
inline constexpr double kCritical = 4.417;

/// Whether the estimate lies within kCritical standard errors of the truth. Rounding in float is
/// allowed for by one part in 1e5: the estimate of a constant has no spread at all.
bool Agrees(const Estimate& estimate, double truth);
bool Agree(const Estimate& a, const Estimate& b);

/// Expects the frame's mean of green to agree with the truth, and as a control not to agree with
/// one that is larger by the part `detectable`.
void ExpectMean(const Partial& partial, double truth, double detectable = 0.01);

}  // namespace strata
