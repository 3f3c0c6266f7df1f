#include "worker/geometry/plain_images.h"

#include "worker/math/cpu_clones.h"

namespace strata {
namespace {

/// Asks memory for what starts there. By hand: gcc 12 takes a function that does no more than
/// __builtin_prefetch for one without effect, and leaves it out.
void Fetch(const void* at) { asm volatile("prefetcht0 (%0)" : : "r"(at)); }

}  // namespace

STRATA_CPU_CLONES void PlainImages::Begin(IntLanes id, Vec2Lanes uv, MaskLanes mask,
                                          Begun* begun) const {
  constexpr int32_t kStride = sizeof(Row) / sizeof(float);
  const RowLanes map = GatherRows(rows_.front().mapping.data(), id * kStride, mask),
                 row = GatherRows(rows_.front().size_scale_wraps.data(), id * kStride, mask);
  const FloatLanes width = row.v[0], height = row.v[1];
  const IntLanes wraps = reinterpret_cast<IntLanes>(row.v[3]);
  const FloatLanes x = Reduce(map.v[0] * uv.x + map.v[2], (wraps & kRepeatS) != 0) * width - 0.5f;
  const FloatLanes y =
      Reduce(1 - (map.v[1] * uv.y + map.v[3]), (wraps & kRepeatT) != 0) * height - 0.5f;
  const FloatLanes left = Floor(x), top = Floor(y);
  const MaskLanes inside =
      mask & (left >= 0) & (top >= 0) & (left + 1 < width) & (top + 1 < height);
  *begun = {inside, id, ToInt(top) * ToInt(width) + ToInt(left), x - left, y - top, row.v[2]};
  const Indices at(*begun);
  ForEachLane(inside, [&](int lane) {
    const Image& image = images_[at.id[lane]];
    const char* first = image.data + size_t(at.texel[lane]) * image.texel_bytes;
    Fetch(first);
    Fetch(first + image.row_bytes);
  });
}

STRATA_CPU_CLONES RgbLanes PlainImages::Finish(const Begun& begun) const {
  // Written to memory number by number: a vector would be taken there and back for each.
  alignas(32) float corners[4][3][kLanes];
  const Indices at(begun);
  ForEachLane(begun.lanes, [&](int lane) {
    const Image& image = images_[at.id[lane]];
    const ImageTexels& texels = *image.texels;
    const size_t right = static_cast<size_t>(texels.channels), below = right * texels.width;
    const size_t first = size_t(at.texel[lane]) * right;
    const auto read = [&](int corner, size_t i) {
      const Rgb color = texels.At(i, *image.table);
      corners[corner][0][lane] = color.r;
      corners[corner][1][lane] = color.g;
      corners[corner][2][lane] = color.b;
    };
    read(0, first);
    read(1, first + right);
    read(2, first + below);
    read(3, first + below + right);
  });
  const auto corner = [&](int i) {
    return RgbLanes{_mm256_load_ps(corners[i][0]), _mm256_load_ps(corners[i][1]),
                    _mm256_load_ps(corners[i][2])};
  };
  const FloatLanes fx = begun.fx, fy = begun.fy;
  return ((corner(0) * (1 - fx) + corner(1) * fx) * (1 - fy) +
          (corner(2) * (1 - fx) + corner(3) * fx) * fy) *
         begun.scale;
}

}  // namespace strata
