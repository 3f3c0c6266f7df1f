#pragma once

#include <optional>

#include "worker/geometry/geometry.h"
#include "worker/light/light_sample.h"
#include "worker/light/triangle_light.h"

namespace strata {

/// Any other emissive shape (PBRT 12.4), sampled over its area through the geometry that holds it.
struct ShapeLight {
  const Geometry* geometry = nullptr;
  OtherEmitter shape;
  Rgb radiance;
  bool two_sided = false;
  float area = 0;
};

inline Rgb Le(const ShapeLight& light, Vec3f ng, Vec3f wo) {
  return light.two_sided || Dot(ng, wo) > 0 ? light.radiance : Rgb{};
}

inline float PdfLi(const ShapeLight& light, Vec3f /*from*/, const EmissionHit& hit) {
  const float pdf_area = light.geometry->EmitterPdfArea(light.shape, hit.p);
  return AreaToSolidAngle(pdf_area, hit.ng, hit.wi, hit.distance * hit.distance);
}

inline std::optional<LightSample> SampleLi(const ShapeLight& light, Vec3f from, Vec2f u) {
  const EmitterPoint point = light.geometry->SampleEmitter(light.shape, u);
  const Vec3f to_light = point.p - from;
  const float distance2 = LengthSquared(to_light);
  if (!(distance2 > 0)) return std::nullopt;
  LightSample sample;
  sample.wi = to_light / std::sqrt(distance2);
  sample.radiance = Le(light, point.ng, -sample.wi);
  sample.pdf = AreaToSolidAngle(point.pdf_area, point.ng, sample.wi, distance2);
  if (!(sample.pdf > 0) || IsBlack(sample.radiance)) return std::nullopt;
  sample.end = OffsetRayOrigin(point.p, point.offset, point.ng, -to_light);
  return sample;
}

}  // namespace strata
