#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "common/status.h"
#include "worker/geometry/geometry.h"
#include "worker/light/light.h"
#include "worker/light/light_bounds.h"
#include "worker/scene/build_options.h"

namespace strata {

/// A light at a place, with what choosing among them looks at.
struct PlacedLight {
  Light light;
  LightBounds bounds;    ///< Without an intensity.
  double intensity = 0;  ///< Luminance along a normal, per solid angle.
  double power = 0;
  bool masked = false;  ///< By alpha: not to be sampled, its points may not be there.
};

/// The emissive surfaces of a scene as lights.
struct SurfaceLights {
  std::vector<PlacedLight> lights;
  std::vector<uint32_t> light_of_surface;                  ///< By SurfacePoint::light.
  std::vector<std::unique_ptr<TexturedSurface>> textured;  ///< What TexturedLights point to.
};

/// `geometry` and `textures` must outlive the lights.
SurfaceLights MakeSurfaceLights(const Geometry& geometry, const TextureSet& textures,
                                const BuildOptions& options);
PlacedLight MakePointLight(const PointLightDescription& description);
PlacedLight MakeSpotLight(const SpotLightDescription& description);
/// `projection` and `diagram` must outlive the light.
PlacedLight MakeProjectionLight(const ProjectionLightDescription& description,
                                const Projection& projection);
/// INVALID_ARGUMENT for a transform that shears and a diagram too dark to be given a power.
absl::StatusOr<PlacedLight> MakeGoniometricLight(const GoniometricLightDescription& description,
                                                 const Diagram& diagram);

}  // namespace strata
