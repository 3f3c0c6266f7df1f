#pragma once

#include "worker/bsdf/material.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/geometry/texture.h"

namespace strata {

/// Which of eight surfaces have a Lambertian base (see BaseRow), bare or under a coat. Textures are
/// looked up in two steps.
struct BaseLanes {
  MaskLanes bare = {}, coated = {};
  RgbLanes reflectance;  ///< Where no texture has it.
  TextureSet::BegunLanes textured;
};

/// What is looked for: bare bases of constant reflectance alone, or those with
struct BaseSearch {
  bool coats = false;     ///< coats,
  bool textures = false;  ///< textures.
};

/// Of the lanes in `mask`.
inline BaseLanes FindBases(const MaterialSet& materials, const TextureSet& textures,
                           const SurfaceLanes& surfaces, MaskLanes mask, BaseSearch search) {
  constexpr int32_t kStride = sizeof(BaseRow) / sizeof(float);
  const BaseRow* rows = materials.base_rows().data();
  const RowLanes row = GatherRows(&rows->reflectance.r, surfaces.material * kStride, mask);
  const IntLanes flags = reinterpret_cast<IntLanes>(row.v[3]);
  const MaskLanes base = mask & ((flags & BaseRow::kBase) != 0);
  const MaskLanes coat = (flags & BaseRow::kCoat) != 0;
  BaseLanes lanes = {base & ~coat, MaskLanes{}, {row.v[0], row.v[1], row.v[2]}};
  if (search.coats) lanes.coated = base & coat;
  if (!search.textures) return lanes;
  const MaskLanes textured = (lanes.bare | lanes.coated) & ((flags & BaseRow::kTexture) != 0);
  if (!Any(textured)) return lanes;
  static_assert(sizeof(TextureId) == sizeof(float));
  const float* texture_row = &rows->alpha_x;
  const IntLanes texture = reinterpret_cast<IntLanes>(
      GatherRows(texture_row, surfaces.material * kStride, textured).v[3]);
  lanes.textured = textures.Begin(texture, surfaces.uv, textured);
  return lanes;
}

/// The reflectances of bases that were found.
inline RgbLanes ReflectancesOf(const BaseLanes& bases, const TextureSet& textures, Vec3Lanes p) {
  if (!Any(bases.textured.lanes)) return bases.reflectance;
  const RgbLanes found = textures.Finish(bases.textured, p);
  // Not a number stays that, to be counted as the defect it is.
  const auto clamp = [](FloatLanes v) { return Min(Max(v, FloatLanes{}), SameFloat(1)); };
  return Select(bases.textured.lanes, {clamp(found.r), clamp(found.g), clamp(found.b)},
                bases.reflectance);
}

}  // namespace strata
