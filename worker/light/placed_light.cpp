#include "worker/light/placed_light.h"

#include <numbers>
#include <optional>
#include <utility>

#include "worker/geometry/parallelogram.h"
#include "worker/math/vec3d.h"

namespace strata {
namespace {

constexpr float kPointRounding = 6 * 0x1p-24f;  // gamma(6) of PBRT 6.8.1.

Light SurfaceLight(const Emitter& emitter, const Geometry& geometry) {
  if (const auto* triangle = std::get_if<TriangleEmitter>(&emitter.shape)) {
    const Vec3f bound = Abs(triangle->p0) + Abs(triangle->p1) + Abs(triangle->p2);
    return TriangleLight{triangle->p0,
                         triangle->p1 - triangle->p0,
                         triangle->p2 - triangle->p0,
                         triangle->ng,
                         bound * kPointRounding,
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

/// Distances, in roots of its area, up to which a rectangle is sampled by solid angle: beyond, the
/// density per area hardly varies, and it costs more than it gains.
constexpr float kNearDistance = 1;

/// The parallelogram that two triangles with a common edge make, if they do.
std::optional<QuadLight> QuadOf(const Emitter& a, const Emitter& b, bool solid_angle) {
  const auto* first = std::get_if<TriangleEmitter>(&a.shape);
  const auto* second = std::get_if<TriangleEmitter>(&b.shape);
  if (!first || !second || a.radiance != b.radiance || a.two_sided != b.two_sided)
    return std::nullopt;
  if (!(Dot(first->ng, second->ng) > 1 - 1e-6f)) return std::nullopt;
  const std::optional<Parallelogram> shape =
      ParallelogramOf({first->p0, first->p1, first->p2}, {second->p0, second->p1, second->p2});
  if (!shape) return std::nullopt;
  QuadLight quad = {shape->corner, shape->edge1, shape->edge2, first->ng};
  // The surface itself may lie off the parallelogram by as much as its fourth corner does.
  const Vec3f ends = Abs(quad.corner + quad.edge1) + Abs(quad.corner + quad.edge2);
  quad.p_error = (Abs(quad.corner) + ends) * kPointRounding + Abs(shape->off);
  quad.pdf_area = 1 / (a.area + b.area);
  quad.radiance = a.radiance;
  quad.two_sided = a.two_sided;
  quad.length1 = Length(quad.edge1);
  quad.length2 = Length(quad.edge2);
  quad.unit1 = quad.edge1 / quad.length1;
  quad.unit2 = quad.edge2 / quad.length2;
  const bool rectangle = AbsDot(quad.unit1, quad.unit2) <= 1e-6f;
  if (rectangle && solid_angle) quad.near2 = kNearDistance * kNearDistance * (a.area + b.area);
  return quad;
}

LightBounds BoundsOf(const Light& light) {
  if (const auto* t = std::get_if<TriangleLight>(&light)) {
    const Vec3f p1 = t->p0 + t->edge1, p2 = t->p0 + t->edge2;
    return {Min(t->p0, Min(p1, p2)), Max(t->p0, Max(p1, p2)), t->ng, 1};
  }
  if (const auto* q = std::get_if<QuadLight>(&light)) {
    const Vec3f p1 = q->corner + q->edge1, p2 = q->corner + q->edge2, p3 = p1 + q->edge2;
    return {Min(Min(q->corner, p1), Min(p2, p3)), Max(Max(q->corner, p1), Max(p2, p3)), q->ng, 1};
  }
  if (const auto* sphere = std::get_if<SphereLight>(&light)) {
    const Vec3f radius = {sphere->radius, sphere->radius, sphere->radius};
    return {sphere->center - radius, sphere->center + radius};
  }
  const OtherEmitter& shape = std::get<ShapeLight>(light).shape;
  if (shape.flat) return {shape.min, shape.max, shape.ng, 1};
  return {shape.min, shape.max};
}

/// The luminance of the intensity along the normal, or, of what is not flat, of its shadow's mean
/// if it is convex: a quarter of its area.
double IntensityOf(const Emitter& emitter) {
  const auto* other = std::get_if<OtherEmitter>(&emitter.shape);
  const bool flat = other ? other->flat : std::holds_alternative<TriangleEmitter>(emitter.shape);
  return (flat ? 1 : 0.25) * double{emitter.area} * Luminance(emitter.radiance);
}

double Power(const Emitter& emitter) {
  return std::numbers::pi * emitter.area * Luminance(emitter.radiance) *
         (emitter.two_sided ? 2 : 1);
}

}  // namespace

SurfaceLights MakeSurfaceLights(const Geometry& geometry, const LightOptions& options) {
  SurfaceLights result;
  const std::vector<Emitter>& emitters = geometry.emitters();
  for (size_t i = 0; i < emitters.size(); ++i) {
    PlacedLight placed = {
        SurfaceLight(emitters[i], geometry), {}, IntensityOf(emitters[i]), Power(emitters[i])};
    result.light_of_surface.push_back(static_cast<uint32_t>(result.lights.size()));
    std::optional<QuadLight> quad;
    if (options.quads && i + 1 < emitters.size())
      quad = QuadOf(emitters[i], emitters[i + 1], options.solid_angle);
    if (quad) {
      placed.light = *quad;
      placed.intensity += IntensityOf(emitters[i + 1]);
      placed.power += Power(emitters[i + 1]);
      result.light_of_surface.push_back(result.light_of_surface.back());
    }
    placed.bounds = BoundsOf(placed.light);
    placed.bounds.two_sided = emitters[i].two_sided;
    result.lights.push_back(std::move(placed));
    if (quad) ++i;
  }
  return result;
}

PlacedLight MakePointLight(const PointLightDescription& description) {
  const Vec3f position = ToFloat(description.position);
  const double intensity = Luminance(description.intensity);
  return {PointLight{position, description.intensity},
          {position, position},
          intensity,
          4 * std::numbers::pi * intensity};
}

}  // namespace strata
