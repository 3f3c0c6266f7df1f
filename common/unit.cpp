#include "common/unit.h"

#include <algorithm>
#include <bit>

namespace strata {

std::vector<SampleRange> CutPieces(SampleRange range) {
  std::vector<SampleRange> pieces;
  while (range.begin < range.end) {
    // The longest elementary block that starts here: at most as long as `begin` is aligned to.
    const uint32_t aligned = range.begin == 0 ? kMaxPiece : range.begin & (0u - range.begin);
    const uint32_t length = std::min({aligned, kMaxPiece, std::bit_floor(range.Count())});
    pieces.push_back({range.begin, range.begin + length});
    range.begin += length;
  }
  return pieces;
}

}  // namespace strata
