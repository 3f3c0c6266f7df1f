#include "common/unit.h"

#include <algorithm>
#include <bit>

namespace strata {

uint32_t LongestPiece(SampleRange range) {
  return std::max(uint32_t{32}, std::bit_floor(range.Count() / 256));
}

std::vector<SampleRange> CutPieces(SampleRange range) {
  const uint32_t longest = LongestPiece(range);
  std::vector<SampleRange> pieces;
  while (range.begin < range.end) {
    // The longest elementary block that starts here: at most as long as `begin` is aligned to.
    const uint32_t aligned = range.begin == 0 ? longest : range.begin & (0u - range.begin);
    const uint32_t length = std::min({aligned, longest, std::bit_floor(range.Count())});
    pieces.push_back({range.begin, range.begin + length});
    range.begin += length;
  }
  return pieces;
}

}  // namespace strata
