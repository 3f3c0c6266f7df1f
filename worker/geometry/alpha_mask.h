#pragma once

#include <cstdint>

#include "worker/geometry/texture.h"
#include "worker/math/vec.h"
#include "worker/sampling/hash.h"
#include "worker/scene/description.h"

namespace strata {

inline float AlphaAfterCutoff(const AlphaMask& mask, float alpha) {
  if (!mask.cutoff) return alpha;
  return alpha >= *mask.cutoff ? 1.0f : 0.0f;
}

/// What a ray meets, by numbers that do not depend on how distances were rounded.
struct Meeting {
  uint32_t ray_id = 0;
  uint32_t geometry = 0, primitive = 0, instance = 0;
  bool inside = false;  ///< The inner side: a ray may meet a curved surface twice.
};

/// Whether the surface is there for the ray: with the probability alpha, where that is not 0 or 1
/// by a hash of the meeting (PBRT 7.1.1 hashes origin and direction of the ray, whose last bits
/// differ between kernels). `uv` and the world-space point `p` are where the texture is looked up.
inline bool IsThere(const AlphaMask& mask, const TextureSet& textures, SurfaceUv uv, Vec3f p,
                    const Meeting& meeting) {
  const float alpha = AlphaAfterCutoff(mask, textures.Eval(mask.texture, uv, p).r);
  if (alpha >= 1) return true;
  if (!(alpha > 0)) return false;
  uint64_t hash =
      HashCombine(meeting.ray_id, (uint64_t{meeting.geometry} << 32) | meeting.primitive);
  hash = HashCombine(hash, (uint64_t{meeting.instance} << 1) | (meeting.inside ? 1 : 0));
  return static_cast<float>(hash >> 40) * 0x1p-24f < alpha;
}

}  // namespace strata
