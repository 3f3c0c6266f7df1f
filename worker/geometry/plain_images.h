#pragma once

#include <array>
#include <limits>
#include <vector>

#include "worker/geometry/image_texels.h"
#include "worker/math/lanes.h"
#include "worker/scene/description.h"

namespace strata {

/// The bilinear image textures of a scene, in colour and repeated or continued beyond their edges,
/// as rows of numbers from which eight are looked up at once.
class PlainImages {
 public:
  /// The next texture's, which is none of these. Textures are numbered from 0.
  void AddOther() { images_.emplace_back(), rows_.emplace_back(); }
  /// The next texture's; `texels` and `table` must outlive this.
  void Add(const ImageTexels& texels, const DecodeTable& table, const ImageTexture& texture) {
    AddOther();
    const auto is_plain = [](ImageWrap wrap) {
      return wrap == ImageWrap::kRepeat || wrap == ImageWrap::kClamp;
    };
    const UvMapping& mapping = texture.mapping;
    const ImageWrap wrap_t = texture.wrap_t.value_or(texture.wrap);
    if (!is_plain(texture.wrap) || !is_plain(wrap_t) || texture.nearest || texture.invert ||
        texture.scalar || texture.channel || texture.second_uv || mapping.s_v != 0 ||
        mapping.t_u != 0 || int64_t{texels.width} * texels.height > kMostTexels)
      return;
    images_.back() = {&texels, &table, static_cast<const char*>(texels.data()), texels.TexelBytes(),
                      texels.TexelBytes() * texels.width};
    const int32_t wraps = (texture.wrap == ImageWrap::kRepeat ? kRepeatS : 0) |
                          (wrap_t == ImageWrap::kRepeat ? kRepeatT : 0);
    rows_.back() = {{mapping.su, mapping.sv, mapping.du, mapping.dv},
                    {static_cast<float>(texels.width), static_cast<float>(texels.height),
                     texture.scale, __builtin_bit_cast(float, wraps)}};
  }

  /// A look-up that has been begun: what it needs has been asked of memory, which takes its time.
  struct Begun {
    MaskLanes lanes = {};  ///< Those that can be finished here.
    IntLanes id = {}, texel = {};
    FloatLanes fx = {}, fy = {}, scale = {};
  };
  /// Begins to look up textures `id` in the lanes of `mask` where that is done here: the others are
  /// of other textures, or the four pixels around the point lie across an edge.
  void Begin(IntLanes id, Vec2Lanes uv, MaskLanes mask, Begun* begun) const;

  RgbLanes Finish(const Begun& begun) const;

 private:
  static constexpr int64_t kMostTexels = std::numeric_limits<int32_t>::max();
  static constexpr int32_t kRepeatS = 1, kRepeatT = 2;
  struct Image {
    const ImageTexels* texels = nullptr;
    const DecodeTable* table = nullptr;
    // Where the texels lie in memory.
    const char* data = nullptr;
    size_t texel_bytes = 0, row_bytes = 0;
  };
  /// In fours for GatherRows; a width of 0 for other textures.
  struct Row {
    std::array<float, 4> mapping = {};  ///< su, sv, du, dv of the UvMapping.
    std::array<float, 4> size_scale_wraps = {};
  };

  /// In memory, since each is looked at by itself.
  struct Indices {
    explicit Indices(const Begun& begun) {
      _mm256_store_si256(reinterpret_cast<__m256i*>(id), reinterpret_cast<__m256i>(begun.id));
      _mm256_store_si256(reinterpret_cast<__m256i*>(texel), reinterpret_cast<__m256i>(begun.texel));
    }
    alignas(32) int32_t id[kLanes], texel[kLanes];
  };

  /// Of texture.cpp, for two of the ways to go on beyond the edges.
  static FloatLanes Reduce(FloatLanes s, MaskLanes repeats) {
    s = repeats ? s - Floor(s) : s;
    return s >= -1 ? Min(s, SameFloat(2)) : SameFloat(-1);
  }

  std::vector<Image> images_;
  std::vector<Row> rows_;
};

}  // namespace strata
