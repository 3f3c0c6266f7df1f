#include "worker/light/placed_light.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "worker/geometry/parallelogram.h"
#include "worker/math/vec3d.h"
#include "worker/sampling/warp.h"

namespace strata {
namespace {

/// Of points on triangles and parallelograms, over the sum of their corners (gamma(6) of
/// PBRT 6.8.1), and of where rays start off them.
constexpr float kPointRounding = Gamma(9);

/// Distances, in roots of its area, up to which a triangle or rectangle is sampled by solid angle:
/// beyond, the density per area hardly varies, and it costs more than it gains.
constexpr float kNearDistance = 1;

SurfaceLight LightOf(const Emitter& emitter, const Geometry& geometry,
                     const BuildOptions& options) {
  if (const auto* triangle = std::get_if<TriangleEmitter>(&emitter.shape)) {
    const Vec3f bound = Abs(triangle->p0) + Abs(triangle->p1) + Abs(triangle->p2);
    return TriangleLight{triangle->p0,
                         triangle->p1 - triangle->p0,
                         triangle->p2 - triangle->p0,
                         triangle->ng,
                         Dot(Abs(triangle->ng), bound) * kPointRounding,
                         1 / emitter.area,
                         emitter.radiance,
                         emitter.two_sided,
                         options.solid_angle ? kNearDistance * kNearDistance * emitter.area : 0};
  }
  if (const auto* sphere = std::get_if<SphereEmitter>(&emitter.shape))
    return SphereLight{sphere->center,   sphere->radius,    sphere->inward,
                       emitter.radiance, emitter.two_sided, options.sphere_cones};
  return ShapeLight{&geometry, std::get<OtherEmitter>(emitter.shape), emitter.radiance,
                    emitter.two_sided, emitter.area};
}

FlatUv UvOf(const TriangleEmitter& triangle) {
  const Vec3d p0 = ToDouble(triangle.p0);
  const Vec3d edge1 = ToDouble(triangle.p1) - p0, edge2 = ToDouble(triangle.p2) - p0;
  // The weights of the second and third corner are dual1 . (p - p0) and dual2 . (p - p0).
  const Vec3d cross = Cross(edge1, edge2);
  const double scale = 1 / Dot(cross, cross);
  const Vec3d dual1 = Cross(edge2, cross) * scale, dual2 = Cross(cross, edge1) * scale;
  const auto gradient = [&](double c0, double c1, double c2) {
    return ToFloat(dual1 * (c1 - c0) + dual2 * (c2 - c0));
  };
  return {triangle.p0, triangle.uv0, gradient(triangle.uv0.x, triangle.uv1.x, triangle.uv2.x),
          gradient(triangle.uv0.y, triangle.uv1.y, triangle.uv2.y)};
}

/// Whether the map gives the triangle the (u, v) that it has.
bool Continues(const FlatUv& map, const TriangleEmitter& triangle) {
  const auto near = [&](Vec3f p, Vec2f uv) {
    constexpr float kTolerance = 1e-5f;
    const Vec2f at = map.At(p);
    return std::abs(at.x - uv.x) <= kTolerance * std::max(1.0f, std::abs(uv.x)) &&
           std::abs(at.y - uv.y) <= kTolerance * std::max(1.0f, std::abs(uv.y));
  };
  return near(triangle.p0, triangle.uv0) && near(triangle.p1, triangle.uv1) &&
         near(triangle.p2, triangle.uv2);
}

/// The parallelogram that two triangles with a common edge make, if they do.
std::optional<QuadLight> QuadOf(const Emitter& a, const Emitter& b, bool solid_angle) {
  const auto* first = std::get_if<TriangleEmitter>(&a.shape);
  const auto* second = std::get_if<TriangleEmitter>(&b.shape);
  if (!first || !second || a.radiance != b.radiance || a.two_sided != b.two_sided ||
      a.texture != b.texture || a.masked != b.masked)
    return std::nullopt;
  if (a.texture != kNoTexture && !Continues(UvOf(*first), *second)) return std::nullopt;
  if (!(Dot(first->ng, second->ng) > 1 - 1e-6f)) return std::nullopt;
  const std::optional<Parallelogram> shape =
      ParallelogramOf({first->p0, first->p1, first->p2}, {second->p0, second->p1, second->p2});
  if (!shape) return std::nullopt;
  QuadLight quad = {shape->corner, shape->edge1, shape->edge2, first->ng};
  // The surface itself may lie off the parallelogram by as much as its fourth corner does.
  const Vec3f ends = Abs(quad.corner + quad.edge1) + Abs(quad.corner + quad.edge2);
  quad.offset = Dot(Abs(quad.ng), (Abs(quad.corner) + ends) * kPointRounding + Abs(shape->off));
  quad.pdf_area = 1 / (a.area + b.area);
  quad.radiance = a.radiance;
  quad.two_sided = a.two_sided;
  const RectangleScales scales = ScalesOf(quad.edge1, quad.edge2);
  quad.scale1 = scales.edge1;
  quad.scale2 = scales.edge2;
  const bool rectangle = AbsDot(Normalize(quad.edge1), Normalize(quad.edge2)) <= 1e-6f;
  if (rectangle && solid_angle) quad.near2 = kNearDistance * kNearDistance * (a.area + b.area);
  return quad;
}

LightBounds BoundsOf(const SurfaceLight& light) {
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

/// A point of the emitter, about uniform by area, and its (u, v).
struct TexturePoint {
  Vec3f p;
  Vec2f uv;
};
TexturePoint PointOf(const Emitter& emitter, const Geometry& geometry, Vec2f u) {
  if (const auto* t = std::get_if<TriangleEmitter>(&emitter.shape)) {
    const Vec2f b = SampleTriangle(u);
    const float c = 1 - b.x - b.y;
    return {t->p0 * c + t->p1 * b.x + t->p2 * b.y,
            {t->uv0.x * c + t->uv1.x * b.x + t->uv2.x * b.y,
             t->uv0.y * c + t->uv1.y * b.x + t->uv2.y * b.y}};
  }
  const auto* sphere = std::get_if<SphereEmitter>(&emitter.shape);
  const OtherEmitter shape =
      sphere ? OtherEmitter{sphere->shape} : std::get<OtherEmitter>(emitter.shape);
  const Vec3f p = geometry.SampleEmitter(shape, u).p;
  return {p, geometry.EmitterUv(shape.shape, p)};
}

/// Of the texture that multiplies the emitter's radiance, about its mean.
Rgb MeanFactor(const Emitter& emitter, const Geometry& geometry, const TextureSet& textures) {
  if (emitter.texture == kNoTexture) return Rgb::Gray(1);
  constexpr int kGrid = 16;
  Rgb sum;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const Vec2f u = {(static_cast<float>(i % kGrid) + 0.5f) / kGrid,
                     (static_cast<float>(i / kGrid) + 0.5f) / kGrid};
    const TexturePoint point = PointOf(emitter, geometry, u);
    const Rgb factor = textures.Eval(emitter.texture, point.uv, point.p);
    sum += {std::max(factor.r, 0.0f), std::max(factor.g, 0.0f), std::max(factor.b, 0.0f)};
  }
  return sum / (kGrid * kGrid);
}

/// What the light's radiance integrates to: along the normal by area, or, of what is not flat, over
/// its shadow's mean if it is convex, which is a quarter of its area; and over all directions.
void AddEmission(const Emitter& emitter, Rgb mean_factor, PlacedLight* placed) {
  // A texture that is black at all points of the grid may not be so between them.
  constexpr float kLeast = 1e-4f;
  const float luminance =
      std::max(Luminance(emitter.radiance * mean_factor), kLeast * Luminance(emitter.radiance));
  const auto* other = std::get_if<OtherEmitter>(&emitter.shape);
  const bool flat = other ? other->flat : std::holds_alternative<TriangleEmitter>(emitter.shape);
  placed->intensity += (flat ? 1 : 0.25) * double{emitter.area} * luminance;
  placed->power += std::numbers::pi * emitter.area * luminance * (emitter.two_sided ? 2 : 1);
}

std::variant<FlatUv, CurvedUv> UvOf(const Emitter& emitter, const Geometry& geometry) {
  if (const auto* triangle = std::get_if<TriangleEmitter>(&emitter.shape)) return UvOf(*triangle);
  if (const auto* sphere = std::get_if<SphereEmitter>(&emitter.shape))
    return CurvedUv{&geometry, sphere->shape};
  return CurvedUv{&geometry, std::get<OtherEmitter>(emitter.shape).shape};
}

}  // namespace

SurfaceLights MakeSurfaceLights(const Geometry& geometry, const TextureSet& textures,
                                const BuildOptions& options) {
  SurfaceLights result;
  const std::vector<Emitter>& emitters = geometry.emitters();
  for (size_t i = 0; i < emitters.size(); ++i) {
    const Emitter& emitter = emitters[i];
    SurfaceLight light = LightOf(emitter, geometry, options);
    PlacedLight placed;
    Rgb mean = MeanFactor(emitter, geometry, textures);
    AddEmission(emitter, mean, &placed);
    result.light_of_surface.push_back(static_cast<uint32_t>(result.lights.size()));
    std::optional<QuadLight> quad;
    if (options.quads && i + 1 < emitters.size())
      quad = QuadOf(emitter, emitters[i + 1], options.solid_angle);
    if (quad) {
      light = *quad;
      ++i;
      const Rgb other_mean = MeanFactor(emitters[i], geometry, textures);
      AddEmission(emitters[i], other_mean, &placed);
      mean = (mean + other_mean) * 0.5f;
      result.light_of_surface.push_back(result.light_of_surface.back());
    }
    placed.bounds = BoundsOf(light);
    placed.bounds.two_sided = emitter.two_sided;
    placed.masked = emitter.masked;
    if (emitter.texture == kNoTexture) {
      placed.light = std::visit([](const auto& plain) { return Light(plain); }, light);
    } else {
      result.textured.push_back(std::make_unique<TexturedSurface>(
          TexturedSurface{light, UvOf(emitter, geometry), &textures, emitter.texture, mean}));
      placed.light = TexturedLight{result.textured.back().get()};
    }
    result.lights.push_back(std::move(placed));
  }
  return result;
}

}  // namespace strata
