#pragma once

#include <optional>

#include "common/messages.h"
#include "strata/v1/worker.pb.h"

// Partials travel in chunks of at most 1 MiB. Both sides hold one partial and one chunk at a time.

namespace strata::wire {

inline constexpr size_t kPartialChunkBytes = 1 << 20;
/// A partial larger than this once assembled is refused.
inline constexpr uint64_t kMaxPartialBytes = uint64_t{512} << 20;
/// Edge of the largest tile.
inline constexpr int kMaxTile = 1024;
inline constexpr size_t kMaxReplays = 16;
inline constexpr size_t kMaxCommandBytes = 4096;

/// Cuts a result into chunks.
class PartialChunker {
 public:
  /// `result` has at least one pixel, and vectors as unit.h says.
  explicit PartialChunker(UnitResult result);

  bool Done() const { return next_pixel_ == pixels_; }
  /// Overwrites `chunk` with the next one; only before Done().
  void Next(v1::PartialChunk* chunk);

 private:
  UnitResult result_;
  size_t pixels_ = 0;
  size_t pixels_in_chunk_ = 0;
  size_t next_pixel_ = 0;
};

/// Puts results together again. Memory grows with what arrived, never with what is promised.
class PartialAssembler {
 public:
  /// The whole result with its last chunk, nothing before. INVALID_ARGUMENT when a field breaks
  /// worker.proto's rules; the assembler may not be used afterwards.
  absl::StatusOr<std::optional<UnitResult>> Add(const v1::PartialChunk& chunk);

 private:
  absl::Status Begin(const v1::PartialHeader& header);

  bool open_ = false;
  size_t pixels_ = 0;  ///< Of the open partial.
  UnitResult result_;
};

}  // namespace strata::wire
