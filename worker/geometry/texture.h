#pragma once

#include <memory>
#include <vector>

#include "common/status.h"
#include "worker/geometry/surface_uv.h"
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

  /// A look-up by the first texture coordinates that has been begun. Texels come from memory: to
  /// begin several before the first is finished lets them come at the same time.
  struct BegunLookUp {
    TextureId id = kNoTexture;
    Vec2f uv;
    Vec3f p;
    // Of an image whose four pixels around the point are side by side:
    size_t top_left = 0, bottom_left = 0;
    Vec2f fraction;      ///< Where between them the point lies.
    bool begun = false;  ///< These are set.
  };
  /// Of a texture that NeedsFirstUvOnly.
  BegunLookUp Begin(TextureId id, Vec2f uv, Vec3f p) const;
  /// What Eval gives.
  Rgb Finish(const BegunLookUp& look_up) const;
  bool NeedsFirstUvOnly(TextureId id) const;

  /// True when the texture is the same everywhere.
  bool IsConstant(TextureId id) const;

 private:
  struct State;
  TextureSet();
  std::unique_ptr<State> state_;
};

}  // namespace strata
