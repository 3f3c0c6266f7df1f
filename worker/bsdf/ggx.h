#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/elementary_lanes.h"
#include "worker/sampling/disk.h"

namespace strata {

/// Trowbridge-Reitz (GGX) microfacets with Smith's height-correlated masking (Heitz 2014, JCGT
/// 3(2); PBRT 9.6), one or eight side by side. Directions are local; only |z| of a direction
/// matters unless stated. Where the field divides by cosines these functions do not, so that
/// grazing directions are harmless.
template <typename Float>
struct GgxOf {
  using Vec2 = typename VectorsOf<Float>::Vec2;
  using Vec3 = typename VectorsOf<Float>::Vec3;

  Float alpha_x = {}, alpha_y = {};

  /// Keeps the finite slopes that the functions below need when only one axis is smooth.
  static GgxOf FromAlpha(float alpha_x, float alpha_y) {
    const GgxOf ggx = {alpha_x, alpha_y};
    return ggx.IsSmooth() ? GgxOf{} : GgxOf{std::max(alpha_x, 1e-4f), std::max(alpha_y, 1e-4f)};
  }

  /// Below this the surface is treated as a mirror.
  auto IsSmooth() const { return Max(alpha_x, alpha_y) < 1e-3f; }

  /// Density of microfacet normals (PBRT 9.6.1); unit m.
  Float D(Vec3 m) const {
    // Over and below the fraction times alpha_x^2 alpha_y^2, so that there is one division.
    const Float both = alpha_x * alpha_y, x = alpha_y * m.x, y = alpha_x * m.y, z = both * m.z;
    const Float e = x * x + y * y + z * z;
    return both * both * both / (kPi * e * e);
  }

  /// |v.z| (1 + 2 Lambda(v)).
  Float Stretch(Vec3 v) const {
    const Float x = alpha_x * v.x, y = alpha_y * v.y;
    return Sqrt(v.z * v.z + x * x + y * y);
  }

  /// Masking and shadowing G2(a, b) divided by 4 |a.z| |b.z|.
  Float VisibilityOver4(Vec3 a, Vec3 b) const {
    return 0.5f / (Abs(b.z) * Stretch(a) + Abs(a.z) * Stretch(b));
  }

  /// G2(a, b) / G1(a): what is left of a sample of the normals visible from a.
  Float MaskingRatio(Vec3 a, Vec3 b) const {
    const Float az = Abs(a.z), bz = Abs(b.z);
    const Float stretch_a = Stretch(a);
    return bz * (az + stretch_a) / (bz * stretch_a + az * Stretch(b));
  }

  /// A normal visible from `wo` (wo.z >= 0), with density VisibleNormalPdf: a point of a spherical
  /// cap of the stretched configuration (Dupuy and Benyoub 2023, CGF 42(8); by a disk PBRT 9.6.4).
  Vec3 SampleVisibleNormal(Vec3 wo, Vec2 u) const {
    const Vec3 v = Normalize(Vec3{alpha_x * wo.x, alpha_y * wo.y, wo.z});
    // The half vector's z is kept apart: as z + v.z it would cancel at grazing angles.
    const Float half_z = (1 - u.y) * (1 + v.z);
    const Float z = half_z - v.z;
    const Float sin_theta = Sqrt(Max(Float{}, (1 - z) * (1 + z)));
    const SinCosResult<Float> phi = SinCos2Pi(u.x);
    const Float half_x = sin_theta * phi.cos + v.x;
    const Float half_y = sin_theta * phi.sin + v.y;
    return Normalize(Vec3{alpha_x * half_x, alpha_y * half_y, half_z});
  }

  /// The u that SampleVisibleNormal takes to `m`.
  Vec2 InvertVisibleNormal(Vec3 wo, Vec3 m) const {
    const Vec3 v = Normalize(Vec3{alpha_x * wo.x, alpha_y * wo.y, wo.z});
    const Vec3 half = Normalize(Vec3{m.x / alpha_x, m.y / alpha_y, m.z});
    const Vec3 cap = half * (2 * Dot(v, half)) - v;
    return {TurnOf(cap.x, cap.y), 1 - (cap.z + v.z) / (1 + v.z)};
  }

  /// D(m) G1(wo) max(0, wo . m) / |wo.z|, divided by wo . m. So that of the reflected direction is
  /// a quarter of it.
  Float VisibleNormalPdfOverCos(Vec3 wo, Vec3 m) const {
    return 2 * D(m) / (Abs(wo.z) + Stretch(wo));
  }
};
using Ggx = GgxOf<float>;

}  // namespace strata
