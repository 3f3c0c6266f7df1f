#pragma once

#include <cmath>
#include <optional>

#include "worker/light/light.h"
#include "worker/math/elementary.h"
#include "worker/sampling/warp.h"

// Light as it leaves its source (PBRT 12.1, "SampleLe", and 3rd ed. 16.1.2). For each kind of
// light:
//
//   std::optional<EmittedRay> SampleLe(const X&, const SceneSphere&, Vec2f u_point, Vec2f u_w)
//   LePdf PdfLe(const X&, const SceneSphere&, const Leaving&)   the densities of such a ray
//   Rgb Power(const X&, const SceneSphere&)                     what leaves in all
//
// The mean of EmittedRay::Flux, none counting as 0, is the power.

namespace strata {

/// A sphere that holds the scene. Light from afar enters through a disk as large, outside of it.
struct SceneSphere {
  Vec3f center;
  float radius = 1;

  float DiskArea() const { return kPi * radius * radius; }
};

/// Densities of a ray: per area of its origin (of points, or across a direction from afar) and per
/// solid angle of its direction. 1 where there is nothing to choose.
struct LePdf {
  float position = 1, direction = 1;
};

struct EmittedRay {
  Ray ray;           ///< Off the light's own surface.
  Vec3f ng;          ///< Unit normal of the surface it leaves, on the ray's side; else zero.
  Rgb radiance;      ///< Of points, the intensity; of what is infinitely small, the irradiance.
  float cosine = 1;  ///< Between ray and ng.
  LePdf pdf;

  Rgb Flux() const { return radiance * (cosine / (pdf.position * pdf.direction)); }
};

/// Where a ray leaves: of lights that are no surface, `w` alone counts.
struct Leaving {
  Vec3f p, ng;  ///< On the surface; the unit normal of its outer side.
  Vec3f w;      ///< Unit.
};

// ---- surfaces: Lambert's law about a point chosen by area ----

namespace emission_detail {

/// Half of the rays leave by each side, if there are two.
inline float SurfaceDirectionPdf(bool two_sided, Vec3f ng, Vec3f w) {
  const float cosine = Dot(ng, w);
  return two_sided ? 0.5f * CosineHemispherePdf(std::abs(cosine)) : CosineHemispherePdf(cosine);
}

template <typename X>
std::optional<EmittedRay> LeaveSurface(const X& light, const EmitterPoint& point, Vec2f u) {
  EmittedRay emitted;
  emitted.ng = point.ng;
  if (light.two_sided) {
    const bool back = u.x >= 0.5f;
    u.x = 2 * u.x - (back ? 1 : 0);
    if (back) emitted.ng = -point.ng;
  }
  const Vec3f local = SampleCosineHemisphere(u);
  if (!(local.z > 0 && point.pdf_area > 0)) return std::nullopt;
  const Vec3f w = Frame::FromNormal(emitted.ng).ToWorld(local);
  emitted.ray = {OffsetRayOrigin(point.p, point.offset, point.ng, w), w};
  emitted.radiance = light.radiance;
  emitted.cosine = local.z;
  emitted.pdf = {point.pdf_area, CosineHemispherePdf(local.z) * (light.two_sided ? 0.5f : 1)};
  return emitted;
}

template <typename X>
Rgb SurfacePower(const X& light, float area) {
  return light.radiance * (kPi * area * (light.two_sided ? 2 : 1));
}

}  // namespace emission_detail

inline std::optional<EmittedRay> SampleLe(const TriangleLight& light, const SceneSphere&,
                                          Vec2f u_point, Vec2f u_w) {
  const Vec2f b = SampleTriangle(u_point);
  const Vec3f p = light.p0 + light.edge1 * b.x + light.edge2 * b.y;
  return emission_detail::LeaveSurface(light, {p, light.ng, light.offset, light.pdf_area}, u_w);
}
inline LePdf PdfLe(const TriangleLight& light, const SceneSphere&, const Leaving& ray) {
  return {light.pdf_area, emission_detail::SurfaceDirectionPdf(light.two_sided, ray.ng, ray.w)};
}
inline Rgb Power(const TriangleLight& light, const SceneSphere&) {
  return emission_detail::SurfacePower(light, 1 / light.pdf_area);
}

inline std::optional<EmittedRay> SampleLe(const QuadLight& light, const SceneSphere&, Vec2f u_point,
                                          Vec2f u_w) {
  const Vec3f p = light.corner + (light.edge1 * u_point.x + light.edge2 * u_point.y);
  return emission_detail::LeaveSurface(light, {p, light.ng, light.offset, light.pdf_area}, u_w);
}
inline LePdf PdfLe(const QuadLight& light, const SceneSphere&, const Leaving& ray) {
  return {light.pdf_area, emission_detail::SurfaceDirectionPdf(light.two_sided, ray.ng, ray.w)};
}
inline Rgb Power(const QuadLight& light, const SceneSphere&) {
  return emission_detail::SurfacePower(light, 1 / light.pdf_area);
}

inline std::optional<EmittedRay> SampleLe(const SphereLight& light, const SceneSphere&,
                                          Vec2f u_point, Vec2f u_w) {
  using namespace sphere_light_detail;
  const Vec3f n = SampleUniformSphere(u_point);
  const EmitterPoint point = {light.center + n * light.radius, OuterNormal(light, n),
                              PointOffset(light, n), PdfArea(light)};
  return emission_detail::LeaveSurface(light, point, u_w);
}
inline LePdf PdfLe(const SphereLight& light, const SceneSphere&, const Leaving& ray) {
  return {sphere_light_detail::PdfArea(light),
          emission_detail::SurfaceDirectionPdf(light.two_sided, ray.ng, ray.w)};
}
inline Rgb Power(const SphereLight& light, const SceneSphere&) {
  return emission_detail::SurfacePower(light, 1 / sphere_light_detail::PdfArea(light));
}

inline std::optional<EmittedRay> SampleLe(const ShapeLight& light, const SceneSphere&,
                                          Vec2f u_point, Vec2f u_w) {
  return emission_detail::LeaveSurface(light, light.geometry->SampleEmitter(light.shape, u_point),
                                       u_w);
}
inline LePdf PdfLe(const ShapeLight& light, const SceneSphere&, const Leaving& ray) {
  return {light.geometry->EmitterPdfArea(light.shape, ray.p),
          emission_detail::SurfaceDirectionPdf(light.two_sided, ray.ng, ray.w)};
}
inline Rgb Power(const ShapeLight& light, const SceneSphere&) {
  return emission_detail::SurfacePower(light, light.area);
}

inline std::optional<EmittedRay> SampleLe(const TexturedLight& light, const SceneSphere& scene,
                                          Vec2f u_point, Vec2f u_w) {
  std::optional<EmittedRay> emitted =
      std::visit([&](const auto& plain) { return SampleLe(plain, scene, u_point, u_w); },
                 light.surface->plain);
  if (emitted) emitted->radiance = emitted->radiance * light.surface->Factor(emitted->ray.origin);
  return emitted;
}
inline LePdf PdfLe(const TexturedLight& light, const SceneSphere& scene, const Leaving& ray) {
  return std::visit([&](const auto& plain) { return PdfLe(plain, scene, ray); },
                    light.surface->plain);
}
/// By the texture's mean at the points of a grid.
inline Rgb Power(const TexturedLight& light, const SceneSphere& scene) {
  return std::visit([&](const auto& plain) { return Power(plain, scene); }, light.surface->plain) *
         light.surface->mean;
}

// ---- points ----

inline std::optional<EmittedRay> SampleLe(const PointLight& light, const SceneSphere&, Vec2f,
                                          Vec2f u_w) {
  return EmittedRay{.ray = {light.position, SampleUniformSphere(u_w)},
                    .radiance = light.intensity,
                    .pdf = {1, UniformSpherePdf()}};
}
inline LePdf PdfLe(const PointLight&, const SceneSphere&, const Leaving&) {
  return {1, UniformSpherePdf()};
}
inline Rgb Power(const PointLight& light, const SceneSphere&) {
  return light.intensity * (4 * kPi);
}

/// In proportion to the intensity, which Falloff is along the direction.
inline std::optional<EmittedRay> SampleLe(const SpotLight& light, const SceneSphere&, Vec2f,
                                          Vec2f u_w) {
  const float versine = SampleFalloff(light, u_w.x);
  const Vec3f local = DirectionFromOneMinusCos(versine, u_w.y);
  const float falloff = Falloff(light, versine);
  if (!(falloff > 0)) return std::nullopt;
  return EmittedRay{.ray = {light.position, Frame::FromNormal(light.axis).ToWorld(local)},
                    .radiance = light.intensity * falloff,
                    .pdf = {1, falloff / FalloffIntegral(light.versine_start, light.versine_end)}};
}
inline LePdf PdfLe(const SpotLight& light, const SceneSphere&, const Leaving& ray) {
  return {1, Falloff(light, VersineTo(light, ray.w)) /
                 FalloffIntegral(light.versine_start, light.versine_end)};
}
inline Rgb Power(const SpotLight& light, const SceneSphere&) {
  return light.intensity * FalloffIntegral(light.versine_start, light.versine_end);
}

inline std::optional<EmittedRay> SampleLe(const ProjectionLight& light, const SceneSphere&, Vec2f,
                                          Vec2f u_w) {
  const Projection& projection = *light.projection;
  float pdf = 0;
  const Vec2f st = projection.distribution.Sample(u_w, &pdf);
  const Vec3f local = projection.DirectionAt(st);
  if (!(pdf > 0)) return std::nullopt;
  return EmittedRay{.ray = {light.position, projection.axes.ToWorld(local)},
                    .radiance = projection.PixelAt(st),
                    .pdf = {1, pdf / projection.Density(local.z)}};
}
inline LePdf PdfLe(const ProjectionLight& light, const SceneSphere&, const Leaving& ray) {
  const Projection& projection = *light.projection;
  const Vec3f local = projection.axes.ToLocal(ray.w);
  const std::optional<Vec2f> st = projection.SquareAt(local);
  if (!st) return {1, 0};
  return {1, projection.distribution.Pdf(*st) / projection.Density(local.z)};
}
inline Rgb Power(const ProjectionLight& light, const SceneSphere&) {
  return light.projection->power;
}

inline std::optional<EmittedRay> SampleLe(const GoniometricLight& light, const SceneSphere&, Vec2f,
                                          Vec2f u_w) {
  float pdf = 0;
  const Vec2f st = light.diagram->distribution.Sample(u_w, &pdf);
  if (!(pdf > 0)) return std::nullopt;
  const Vec3f local = EqualAreaSquareToSphere(st);
  return EmittedRay{.ray = {light.position, light.axes.ToWorld(local)},
                    .radiance = light.intensity * light.diagram->At(local),
                    .pdf = {1, pdf * UniformSpherePdf()}};
}
inline LePdf PdfLe(const GoniometricLight& light, const SceneSphere&, const Leaving& ray) {
  const Vec2f st = EqualAreaSphereToSquare(light.axes.ToLocal(ray.w));
  return {1, light.diagram->distribution.Pdf(st) * UniformSpherePdf()};
}
inline Rgb Power(const GoniometricLight& light, const SceneSphere&) {
  return light.intensity * (4 * kPi * light.diagram->mean);
}

// ---- light from afar ----

namespace emission_detail {

/// Against `direction`, which points from the scene to the light, through the scene's disk.
inline EmittedRay ComeFromAfar(const SceneSphere& scene, Vec3f direction, Rgb radiance,
                               float pdf_direction, Vec2f u_point) {
  const Vec2f d = SampleConcentricDisk(u_point);
  const Vec3f offset = Frame::FromNormal(direction).ToWorld({d.x, d.y, 1});
  return {.ray = {scene.center + offset * scene.radius, -direction},
          .radiance = radiance,
          .pdf = {1 / scene.DiskArea(), pdf_direction}};
}

/// Half of the directions are those of SampleLi, which may leave out what another way finds (see
/// EnvironmentImage), half are even.
template <typename Environment>
float EnvironmentDirectionPdf(const Environment& light, Vec3f direction) {
  return 0.5f * (PdfLi(light, direction) + UniformSpherePdf());
}
template <typename Environment>
std::optional<EmittedRay> LeaveEnvironment(const Environment& light, const SceneSphere& scene,
                                           Vec2f u_point, Vec2f u) {
  const bool even = u.x >= 0.5f;
  u.x = 2 * u.x - (even ? 1 : 0);
  Vec3f direction;
  if (even) {
    direction = SampleUniformSphere(u);
  } else {
    const std::optional<LightSample> sample = SampleLi(light, scene.center, u);
    if (!sample) return std::nullopt;
    direction = sample->wi;
  }
  return ComeFromAfar(scene, direction, Le(light, direction),
                      EnvironmentDirectionPdf(light, direction), u_point);
}

}  // namespace emission_detail

inline std::optional<EmittedRay> SampleLe(const DistantLight& light, const SceneSphere& scene,
                                          Vec2f u_point, Vec2f) {
  return emission_detail::ComeFromAfar(scene, light.direction, light.irradiance, 1, u_point);
}
inline LePdf PdfLe(const DistantLight&, const SceneSphere& scene, const Leaving&) {
  return {1 / scene.DiskArea(), 1};
}
inline Rgb Power(const DistantLight& light, const SceneSphere& scene) {
  return light.irradiance * scene.DiskArea();
}

inline std::optional<EmittedRay> SampleLe(const ConstantEnvironment& light,
                                          const SceneSphere& scene, Vec2f u_point, Vec2f u_w) {
  return emission_detail::ComeFromAfar(scene, SampleUniformSphere(u_w), light.radiance,
                                       UniformSpherePdf(), u_point);
}
inline LePdf PdfLe(const ConstantEnvironment&, const SceneSphere& scene, const Leaving&) {
  return {1 / scene.DiskArea(), UniformSpherePdf()};
}
inline Rgb Power(const ConstantEnvironment& light, const SceneSphere& scene) {
  return light.radiance * (4 * kPi * scene.DiskArea());
}

inline std::optional<EmittedRay> SampleLe(const ImageEnvironment& light, const SceneSphere& scene,
                                          Vec2f u_point, Vec2f u_w) {
  return emission_detail::LeaveEnvironment(light, scene, u_point, u_w);
}
inline LePdf PdfLe(const ImageEnvironment& light, const SceneSphere& scene, const Leaving& ray) {
  return {1 / scene.DiskArea(), emission_detail::EnvironmentDirectionPdf(light, -ray.w)};
}
inline Rgb Power(const ImageEnvironment& light, const SceneSphere& scene) {
  return light.image->mean * (4 * kPi * scene.DiskArea());
}

/// Rays leave the portal itself, from outside.
inline std::optional<EmittedRay> SampleLe(const PortalEnvironment& light, const SceneSphere&,
                                          Vec2f u_point, Vec2f u_w) {
  const PortalImage& portal = *light.portal;
  float pdf = 0;
  const Vec3f local = portal.DirectionAt(portal.distribution.Sample({}, u_w, &pdf));
  if (!(local.z > 0)) return std::nullopt;
  pdf = PortalImage::PerSolidAngle(pdf, local);
  if (!(pdf > 0)) return std::nullopt;
  const Vec3f direction = portal.axes.ToWorld(local);
  const Vec3f p = portal.corner + portal.axes.x * (u_point.x * portal.width) +
                  portal.axes.y * (u_point.y * portal.height);
  return EmittedRay{.ray = {p, -direction},
                    .ng = -portal.axes.z,
                    .radiance = Le(ImageEnvironment{&portal.sky}, direction),
                    .cosine = local.z,
                    .pdf = {1 / portal.Area(), pdf}};
}
inline LePdf PdfLe(const PortalEnvironment& light, const SceneSphere&, const Leaving& ray) {
  const PortalImage& portal = *light.portal;
  const Vec3f local = portal.axes.ToLocal(-ray.w);
  const std::optional<Vec2f> st = portal.SquareAt(local);
  if (!st) return {1 / portal.Area(), 0};
  return {1 / portal.Area(), PortalImage::PerSolidAngle(portal.distribution.Pdf({}, *st), local)};
}
/// By the picture at the points of a grid.
inline Rgb Power(const PortalEnvironment& light, const SceneSphere&) {
  return light.portal->irradiance * light.portal->Area();
}

}  // namespace strata
