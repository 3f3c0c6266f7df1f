#pragma once

#include "worker/bsdf/material.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/geometry/texture.h"

namespace strata {

/// Which of eight surfaces have a Lambertian base (see BaseRow), bare or under a coat, or are
/// smooth glass. Textures are looked up in two steps.
struct BaseLanes {
  MaskLanes bare = {}, coated = {}, glass = {};
  RgbLanes reflectance;  ///< Where no texture has it.
};

/// What is looked for: bare bases of constant reflectance alone, or those with
struct BaseSearch {
  bool coats = false;     ///< coats and glass,
  bool textures = false;  ///< textures.
};

/// BaseRow::flags of the lanes in `mask`.
inline IntLanes FlagsOf(const MaterialSet& materials, IntLanes material, MaskLanes mask) {
  constexpr int32_t kStride = sizeof(BaseRow) / sizeof(float);
  const BaseRow* rows = materials.base_rows().data();
  return AsInts(GatherRows(&rows->reflectance.r, material * kStride, mask).v[3]);
}

/// Of the lanes in `mask`. If textures are looked for, their look-ups are begun in `textured`.
inline BaseLanes FindBases(const MaterialSet& materials, const TextureSet& textures,
                           const SurfaceLanes& surfaces, MaskLanes mask, BaseSearch search,
                           TextureSet::BegunLanes* textured) {
  constexpr int32_t kStride = sizeof(BaseRow) / sizeof(float);
  const BaseRow* rows = materials.base_rows().data();
  const RowLanes row = GatherRows(&rows->reflectance.r, surfaces.material * kStride, mask);
  const IntLanes flags = reinterpret_cast<IntLanes>(row.v[3]);
  const MaskLanes base = mask & ((flags & BaseRow::kBase) != 0);
  const MaskLanes coat = (flags & BaseRow::kCoat) != 0;
  BaseLanes lanes;
  lanes.bare = base & ~coat;
  lanes.reflectance = {row.v[0], row.v[1], row.v[2]};
  if (search.coats) {
    lanes.coated = base & coat;
    lanes.glass = mask & ((flags & BaseRow::kGlass) != 0);
  }
  if (!search.textures) return lanes;
  textured->lanes = (lanes.bare | lanes.coated) & ((flags & BaseRow::kTexture) != 0);
  if (!Any(textured->lanes)) return lanes;
  static_assert(sizeof(TextureId) == sizeof(float));
  const float* texture_row = &rows->alpha_x;
  const IntLanes texture = reinterpret_cast<IntLanes>(
      GatherRows(texture_row, surfaces.material * kStride, textured->lanes).v[3]);
  textures.Begin(texture, surfaces.uv, textured->lanes, textured);
  return lanes;
}

/// The reflectances of bases, of which some were begun to be looked up; `plain` those of the
/// others.
inline RgbLanes FinishReflectances(const TextureSet::BegunLanes& textured,
                                   const TextureSet& textures, Vec3Lanes p, RgbLanes plain) {
  if (!Any(textured.lanes)) return plain;
  const RgbLanes found = textures.Finish(textured, p);
  // Not a number stays that, to be counted as the defect it is.
  const auto clamp = [](FloatLanes v) { return Min(Max(v, FloatLanes{}), SameFloat(1)); };
  return Select(textured.lanes, {clamp(found.r), clamp(found.g), clamp(found.b)}, plain);
}

/// What the material's DielectricBsdf::eta is.
inline FloatLanes GlassEta(const MaterialSet& materials, IntLanes material, MaskLanes mask) {
  constexpr int32_t kStride = sizeof(BaseRow) / sizeof(float);
  const float* with_eta = &materials.base_rows().front().internal_reflectance.r;
  return GatherRows(with_eta, material * kStride, mask).v[3];
}

}  // namespace strata
