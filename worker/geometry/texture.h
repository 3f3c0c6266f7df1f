#pragma once

#include <memory>
#include <vector>

#include "common/status.h"
#include "worker/geometry/plain_images.h"
#include "worker/geometry/surface_uv.h"
#include "worker/math/lanes.h"
#include "worker/math/vec.h"
#include "worker/scene/description.h"
#include "worker/scene/file_source.h"

namespace strata {

/// All textures of a scene, ready to be looked up. Images that several textures share are loaded
/// once. Thread-safe after Load; look-ups neither lock nor allocate.
class TextureSet {
 public:
  /// NOT_FOUND or INVALID_ARGUMENT with the image's path.
  static absl::StatusOr<std::unique_ptr<TextureSet>> Load(
      const std::vector<TextureDescription>& textures, const FileSource& source);
  ~TextureSet();

  /// `p` is the world-space point, for solid textures. kNoTexture gives black.
  Rgb Eval(TextureId id, SurfaceUv uv, Vec3f p) const;
  /// How far apart in u and v to look it up for differences that are about its derivatives.
  Vec2f Step(TextureId id) const;

  /// Look-ups of textures that NeedsFirstUvOnly, begun in the lanes of `lanes`. Texels take their
  /// time to come from memory, in which other things may be done.
  struct BegunLanes {
    MaskLanes lanes = {};
    Vec2Lanes uv;
    PlainImages::Begun plain;
  };
  void Begin(IntLanes id, Vec2Lanes uv, MaskLanes mask, BegunLanes* begun) const;
  /// What Eval gives in each lane, for the points `p`.
  RgbLanes Finish(const BegunLanes& begun, Vec3Lanes p) const;
  bool NeedsFirstUvOnly(TextureId id) const;

  /// True when the texture is the same everywhere.
  bool IsConstant(TextureId id) const;

 private:
  struct State;
  TextureSet();
  std::unique_ptr<State> state_;
};

}  // namespace strata
