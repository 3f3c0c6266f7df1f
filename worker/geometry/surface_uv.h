#pragma once

#include "worker/math/vec.h"

namespace strata {

/// The texture coordinates of a point of a surface. What has no second ones has the first twice.
struct SurfaceUv {
  Vec2f first, second;

  SurfaceUv() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): nearly all surfaces have one pair.
  SurfaceUv(Vec2f uv) : first(uv), second(uv) {}
  SurfaceUv(float u, float v) : SurfaceUv(Vec2f{u, v}) {}
  SurfaceUv(Vec2f uv, Vec2f second_uv) : first(uv), second(second_uv) {}
};

}  // namespace strata
