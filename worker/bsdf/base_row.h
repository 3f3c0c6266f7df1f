#pragma once

#include <array>
#include <cstdint>

#include "worker/bsdf/albedo_table.h"
#include "worker/bsdf/coated_diffuse.h"
#include "worker/scene/description.h"

namespace strata {

/// What eight paths at once ask of a material with a Lambertian base, bare or under a coat, of
/// which at most the base's reflectance varies over the surface, or of a smooth border between two
/// clear media. In fours for GatherRows.
struct alignas(16) BaseRow {
  static constexpr int32_t kBase = 1;     ///< It is such a material; for others all is as here.
  static constexpr int32_t kCoat = 2;     ///< With a coat.
  static constexpr int32_t kTexture = 4;  ///< `texture` has the reflectance.
  static constexpr int32_t kGlass = 8;    ///< No base: a smooth DielectricBsdf of index `eta`.

  Rgb reflectance;
  int32_t flags = 0;
  // Of the coat: see CoatedDiffuseBsdf.
  Rgb internal_reflectance;
  float eta = 1;
  Rgb optical_depth;
  float mean_entering = 1;
  float alpha_x = 0, alpha_y = 0, escaping_path = 1;
  TextureId texture = kNoTexture;
  AlbedoTable::Row border = {};  ///< Reflectance of a rough border.
  float padding[3] = {};

  /// Of any BSDF without its reflectance.
  void SetCoat(const CoatedDiffuseBsdf& bsdf) {
    flags |= kCoat;
    internal_reflectance = bsdf.InternalReflectance();
    eta = bsdf.coat.interface->eta();
    optical_depth = bsdf.coat.optical_depth;
    mean_entering = bsdf.mean_entering;
    alpha_x = bsdf.coat.ggx.alpha_x;
    alpha_y = bsdf.coat.ggx.alpha_y;
    escaping_path = bsdf.coat.interface->escaping_path();
    if (!bsdf.coat.IsSmooth()) border = bsdf.coat.interface->RoughReflectances(bsdf.coat.Alpha());
  }
};
static_assert(sizeof(BaseRow) == 52 * sizeof(float));

}  // namespace strata
