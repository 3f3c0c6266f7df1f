#include "worker/geometry/surface_detail.h"

#include <cmath>

namespace strata {
namespace {

/// The normal of the map, not normalized.
Vec3f MappedNormal(const SurfaceDetail& detail, const TextureSet& textures,
                   const SurfaceDerivatives& derivatives, const SurfacePoint& point) {
  const Rgb c = textures.Eval(detail.normal_map, point.TextureUv(), point.p);
  Vec3f n = {detail.normal_scale * (2 * c.r - 1), detail.normal_scale * (2 * c.g - 1), 2 * c.b - 1};
  const Frame frame = Frame::FromNormalAndTangent(point.ns, point.dpdu);
  if (detail.y_along_v && Dot(frame.y, derivatives.dpdv) < 0) n.y = -n.y;
  return frame.ToWorld(n);
}

struct Bump {
  Vec3f dpdu, dpdv;
};

/// The tangents of the displaced surface.
Bump BumpAt(TextureId displacement, const TextureSet& textures,
            const SurfaceDerivatives& derivatives, const SurfacePoint& point) {
  const Vec2f uv = point.uv, step = textures.Step(displacement);
  const auto height = [&](Vec2f at, Vec3f p) { return textures.Eval(displacement, at, p).r; };
  const float here = height(uv, point.p);
  const float u = uv.x + step.x, v = uv.y + step.y;
  // What the steps are after rounding.
  const float du = u - uv.x, dv = v - uv.y;
  const float slope_u = (height({u, uv.y}, point.p + derivatives.dpdu * du) - here) / du;
  const float slope_v = (height({uv.x, v}, point.p + derivatives.dpdv * dv) - here) / dv;
  return {derivatives.dpdu + point.ns * slope_u + derivatives.dndu * here,
          derivatives.dpdv + point.ns * slope_v + derivatives.dndv * here};
}

}  // namespace

SurfacePoint ApplyDetail(const SurfaceDetail& detail, const TextureSet& textures,
                         const SurfaceDerivatives& derivatives, const SurfacePoint& point,
                         Vec3f wo) {
  SurfacePoint turned = point;
  Vec3f n;
  if (detail.normal_map != kNoTexture) {
    n = MappedNormal(detail, textures, derivatives, point);
  } else {
    const Bump bump = BumpAt(detail.displacement, textures, derivatives, point);
    n = Cross(bump.dpdu, bump.dpdv);
    if (Dot(n, point.ns) < 0) n = -n;
    turned.dpdu = bump.dpdu;
  }
  const float length = Length(n);
  if (!(length > 0) || !std::isfinite(length)) return point;
  n = n / length;
  if (!(Dot(n, point.ng) > 0)) return point;
  // How far a normal is turned to the viewer at least, as a cosine.
  constexpr float kLeastCosine = 0.01f;
  const Vec3f viewer = Dot(wo, point.ng) < 0 ? -wo : wo;
  const float cosine = Dot(n, viewer);
  turned.ns = cosine < kLeastCosine ? Normalize(n + viewer * (kLeastCosine - cosine)) : n;
  return turned;
}

}  // namespace strata
