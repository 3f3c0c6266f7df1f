#pragma once

#include <algorithm>
#include <cmath>

#include "worker/math/elementary.h"
#include "worker/math/vec.h"
#include "worker/sampling/disk.h"

namespace strata {

/// Trowbridge-Reitz (GGX) microfacets with Smith's height-correlated masking (Heitz 2014, JCGT
/// 3(2)). Directions are local; only |z| of a direction matters unless stated. Where the field
/// divides by cosines these functions do not, so that grazing directions are harmless.
struct Ggx {
  float alpha_x = 0, alpha_y = 0;

  /// Keeps the finite slopes that the functions below need when only one axis is smooth.
  static Ggx FromAlpha(float alpha_x, float alpha_y) {
    const Ggx ggx = {alpha_x, alpha_y};
    return ggx.IsSmooth() ? Ggx{} : Ggx{std::max(alpha_x, 1e-4f), std::max(alpha_y, 1e-4f)};
  }

  /// Below this the surface is treated as a mirror.
  bool IsSmooth() const { return std::max(alpha_x, alpha_y) < 1e-3f; }

  /// Density of microfacet normals; unit m.
  float D(Vec3f m) const {
    const float x = m.x / alpha_x, y = m.y / alpha_y;
    const float e = x * x + y * y + m.z * m.z;
    return 1 / (kPi * alpha_x * alpha_y * e * e);
  }

  /// |v.z| (1 + 2 Lambda(v)).
  float Stretch(Vec3f v) const {
    const float x = alpha_x * v.x, y = alpha_y * v.y;
    return std::sqrt(v.z * v.z + x * x + y * y);
  }

  /// Masking and shadowing G2(a, b) divided by 4 |a.z| |b.z|.
  float VisibilityOver4(Vec3f a, Vec3f b) const {
    return 0.5f / (std::fabs(b.z) * Stretch(a) + std::fabs(a.z) * Stretch(b));
  }

  /// G2(a, b) / G1(a): what is left of a sample of the normals visible from a.
  float MaskingRatio(Vec3f a, Vec3f b) const {
    const float az = std::fabs(a.z), bz = std::fabs(b.z);
    const float stretch_a = Stretch(a);
    return bz * (az + stretch_a) / (bz * stretch_a + az * Stretch(b));
  }

  /// A normal visible from `wo` (wo.z >= 0), with density VisibleNormalPdf: a point of a spherical
  /// cap of the stretched configuration (Dupuy and Benyoub 2023, CGF 42(8)).
  Vec3f SampleVisibleNormal(Vec3f wo, Vec2f u) const {
    const Vec3f v = Normalize(Vec3f{alpha_x * wo.x, alpha_y * wo.y, wo.z});
    // The half vector's z is kept apart: as z + v.z it would cancel at grazing angles.
    const float half_z = (1 - u.y) * (1 + v.z);
    const float z = half_z - v.z;
    const float sin_theta = std::sqrt(std::max(0.0f, (1 - z) * (1 + z)));
    const SinCosResult<float> phi = SinCos2Pi(u.x);
    const float half_x = sin_theta * phi.cos + v.x;
    const float half_y = sin_theta * phi.sin + v.y;
    return Normalize(Vec3f{alpha_x * half_x, alpha_y * half_y, half_z});
  }

  /// The u that SampleVisibleNormal takes to `m`.
  Vec2f InvertVisibleNormal(Vec3f wo, Vec3f m) const {
    const Vec3f v = Normalize(Vec3f{alpha_x * wo.x, alpha_y * wo.y, wo.z});
    const Vec3f half = Normalize(Vec3f{m.x / alpha_x, m.y / alpha_y, m.z});
    const Vec3f cap = half * (2 * Dot(v, half)) - v;
    return {TurnOf(cap.x, cap.y), 1 - (cap.z + v.z) / (1 + v.z)};
  }

  /// D(m) G1(wo) max(0, wo . m) / |wo.z|, divided by wo . m. So that of the reflected direction is
  /// a quarter of it.
  float VisibleNormalPdfOverCos(Vec3f wo, Vec3f m) const {
    return 2 * D(m) / (std::fabs(wo.z) + Stretch(wo));
  }
};

}  // namespace strata
