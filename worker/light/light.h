#pragma once

#include <concepts>
#include <variant>

#include "worker/light/delta_lights.h"
#include "worker/light/environment.h"
#include "worker/light/goniometric_light.h"
#include "worker/light/portal_environment.h"
#include "worker/light/projection_light.h"
#include "worker/light/quad_light.h"
#include "worker/light/shape_light.h"
#include "worker/light/sphere_light.h"
#include "worker/light/spot_light.h"
#include "worker/light/textured_light.h"
#include "worker/light/triangle_light.h"

// All that emits (PBRT 12.1). Each kind is a plain struct with free inline functions in a header of
// its own:
//
//   std::optional<LightSample> SampleLi(const X&, Vec3f from, Vec2f u)
//   float PdfLi(const X&, Vec3f from, const EmissionHit&)    emissive surfaces
//   float PdfLi(const X&, Vec3f direction)                   environments; of portals with the
//                                                            point it is seen from before it
//   float PdfLi(const X&, Vec3f from, Vec3f direction)       points and distant lights: 0
//   Rgb Le(...)                                              what a ray that meets it sees
//   Rgb Intensity(const X&, Vec3f w)                         of points, away from them

namespace strata {

using Light = std::variant<TriangleLight, QuadLight, SphereLight, ShapeLight, TexturedLight,
                           ConstantEnvironment, ImageEnvironment, PortalEnvironment, PointLight,
                           SpotLight, ProjectionLight, GoniometricLight, DistantLight>;

/// A light that fills no solid angle: its LightSample::delta is set.
template <typename X>
concept DeltaLight =
    std::same_as<X, PointLight> || std::same_as<X, SpotLight> || std::same_as<X, ProjectionLight> ||
    std::same_as<X, GoniometricLight> || std::same_as<X, DistantLight>;

/// The density with which SampleLi finds a direction that was chosen in another way: 0, even for
/// the light's own, since no other way chooses that (PBRT 12.2).
template <DeltaLight X>
float PdfLi(const X&, Vec3f /*from*/, Vec3f /*direction*/) {
  return 0;
}

}  // namespace strata
