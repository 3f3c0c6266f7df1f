#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/job.h"

namespace strata {

/// Samples [begin, end) of each replicate's sequence, so 8 * (end - begin) samples of a pixel.
struct SampleRange {
  uint32_t begin = 0, end = 0;
  uint32_t Count() const { return end - begin; }
  bool operator==(const SampleRange&) const = default;
};

/// Names a work unit within its job; also its place in the plan.
struct UnitId {
  uint32_t round = 0;
  uint32_t tile = 0;   ///< Row-major among the tiles of the crop.
  uint32_t piece = 0;  ///< Which piece of each pixel's samples of this round.
  auto operator<=>(const UnitId&) const = default;

  template <typename H>
  friend H AbslHashValue(H state, const UnitId& id) {
    return H::combine(std::move(state), id.round, id.tile, id.piece);
  }
};

/// A value that says what to render. Rendering is a pure function of (scene, job spec, unit).
struct WorkUnit {
  UnitId id;
  PixelRect pixels;                 ///< In frame coordinates.
  std::vector<SampleRange> ranges;  ///< One for all pixels, or one for each, row-major.

  const SampleRange& RangeOf(int64_t pixel) const {
    return ranges.size() == 1 ? ranges.front() : ranges[static_cast<size_t>(pixel)];
  }
  bool operator==(const WorkUnit&) const = default;
};

/// What a worker returns for a unit. All per-pixel vectors run row-major over `pixels`.
struct Partial {
  UnitId unit;
  PixelRect pixels;
  PixelLayout layout;
  std::vector<uint32_t> samples;    ///< Samples of each replicate.
  std::vector<double> values;       ///< layout.Doubles() for each pixel.
  std::vector<uint64_t> rays;       ///< Rays traced: the cost.
  std::vector<uint32_t> nonfinite;  ///< Samples that were NaN or infinite and entered as zero.
  /// Commands that replay the first few non-finite samples.
  std::vector<std::string> replays;
  double render_seconds = 0;  ///< For display alone; decides nothing.
};

/// Cuts [begin, end) into the pieces that are rendered and merged one after the other, in order:
/// elementary blocks of the sequence (powers of two aligned to their length) of at most
/// LongestPiece samples. Depends on the range alone, so the order of floating-point sums does too.
/// 32 samples, or about 1/256 of a long range, so that pieces stay few.
uint32_t LongestPiece(SampleRange range);
std::vector<SampleRange> CutPieces(SampleRange range);

}  // namespace strata
