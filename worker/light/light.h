#pragma once

#include <variant>

#include "worker/light/delta_lights.h"
#include "worker/light/environment.h"
#include "worker/light/quad_light.h"
#include "worker/light/shape_light.h"
#include "worker/light/sphere_light.h"
#include "worker/light/textured_light.h"
#include "worker/light/triangle_light.h"

// All that emits. Each kind is a plain struct with free inline functions in a header of its own:
//
//   std::optional<LightSample> SampleLi(const X&, Vec3f from, Vec2f u)
//   float PdfLi(const X&, Vec3f from, const EmissionHit&)    emissive surfaces
//   float PdfLi(const X&, Vec3f direction)                   environments
//   Rgb Le(...)                                              what a ray that meets it sees

namespace strata {

using Light = std::variant<TriangleLight, QuadLight, SphereLight, ShapeLight, TexturedLight,
                           ConstantEnvironment, ImageEnvironment, PointLight, DistantLight>;

}  // namespace strata
