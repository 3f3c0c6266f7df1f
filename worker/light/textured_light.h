#pragma once

#include <algorithm>
#include <optional>
#include <variant>

#include "worker/geometry/texture.h"
#include "worker/light/quad_light.h"
#include "worker/light/shape_light.h"
#include "worker/light/sphere_light.h"
#include "worker/light/triangle_light.h"

namespace strata {

using SurfaceLight = std::variant<TriangleLight, QuadLight, SphereLight, ShapeLight>;

/// (u, v) over a flat surface: an affine function of the point.
struct FlatUv {
  Vec3f origin;
  Vec2f uv;                      ///< At the origin.
  Vec3f u_gradient, v_gradient;  ///< Within the surface's plane.

  Vec2f At(Vec3f p) const {
    const Vec3f d = p - origin;
    return {uv.x + Dot(u_gradient, d), uv.y + Dot(v_gradient, d)};
  }
};
/// That of any other.
struct CurvedUv {
  const Geometry* geometry = nullptr;
  uint32_t shape = 0;  ///< See Geometry::EmitterUv.

  Vec2f At(Vec3f p) const { return geometry->EmitterUv(shape, p); }
};

/// A surface whose radiance is that of `plain` times a texture (PBRT 12.4). It is sampled as if
/// there were no texture.
struct TexturedSurface {
  SurfaceLight plain;
  std::variant<FlatUv, CurvedUv> uv;
  const TextureSet* textures = nullptr;
  TextureId texture = kNoTexture;
  Rgb mean;  ///< Of Factor, at the points of a grid.

  /// What multiplies the radiance; never negative.
  Rgb Factor(SurfaceUv at_uv, Vec3f p) const {
    const Rgb value = textures->Eval(texture, at_uv, p);
    return {std::max(value.r, 0.0f), std::max(value.g, 0.0f), std::max(value.b, 0.0f)};
  }
  Rgb Factor(Vec3f p) const {
    const Vec2f at_uv = std::visit([&](const auto& map) { return map.At(p); }, uv);
    return Factor(SurfaceUv(at_uv), p);
  }
};

struct TexturedLight {
  const TexturedSurface* surface = nullptr;  ///< Owned by the LightSet.
};

/// `point` is on the surface.
inline Rgb Le(const TexturedLight& light, const SurfacePoint& point, Vec3f wo) {
  const Rgb plain =
      std::visit([&](const auto& l) { return Le(l, point.ng, wo); }, light.surface->plain);
  return IsBlack(plain) ? plain : plain * light.surface->Factor(point.TextureUv(), point.p);
}

inline float PdfLi(const TexturedLight& light, Vec3f from, const EmissionHit& hit) {
  return std::visit([&](const auto& l) { return PdfLi(l, from, hit); }, light.surface->plain);
}

inline std::optional<LightSample> SampleLi(const TexturedLight& light, Vec3f from, Vec2f u) {
  std::optional<LightSample> sample =
      std::visit([&](const auto& l) { return SampleLi(l, from, u); }, light.surface->plain);
  if (!sample) return std::nullopt;
  // Off the surface by no more than the point's own rounding.
  sample->radiance = sample->radiance * light.surface->Factor(sample->end);
  if (IsBlack(sample->radiance)) return std::nullopt;
  return sample;
}

}  // namespace strata
