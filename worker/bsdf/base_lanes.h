#pragma once

#include <array>

#include "worker/bsdf/material.h"
#include "worker/geometry/geometry_lanes.h"
#include "worker/geometry/texture.h"

namespace strata {

/// Which of eight surfaces have a Lambertian base (see BaseRow), bare or under a coat, and of what
/// reflectance.
struct BaseLanes {
  MaskLanes bare = {}, coated = {};
  RgbLanes reflectance;
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
  std::array<TextureSet::BegunLookUp, kLanes> look_ups;
  ForEachLane(textured, [&](int lane) {
    look_ups[lane] =
        textures.Begin(rows[surfaces.material[lane]].texture,
                       {surfaces.uv.x[lane], surfaces.uv.y[lane]}, surfaces.p.Get(lane));
  });
  RgbLanes found;
  ForEachLane(textured, [&](int lane) { found.Set(lane, textures.Finish(look_ups[lane])); });
  // Not a number stays that, to be counted as the defect it is.
  const auto clamp = [](FloatLanes v) { return Min(Max(v, FloatLanes{}), SameFloat(1)); };
  lanes.reflectance =
      Select(textured, {clamp(found.r), clamp(found.g), clamp(found.b)}, lanes.reflectance);
  return lanes;
}

}  // namespace strata
