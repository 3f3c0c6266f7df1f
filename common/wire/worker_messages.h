#pragma once

#include <optional>

#include "common/messages.h"
#include "common/wire/partial_chunks.h"
#include "strata/v1/worker.pb.h"

// The messages of common/messages.h as strata.v1 messages and back.

namespace strata::wire {

/// Gives the strata.v1 messages of one FromWorker, one after the other: several for a UnitResult,
/// made as they are asked for, one for anything else.
class WorkerMessageWriter {
 public:
  explicit WorkerMessageWriter(FromWorker message);
  bool Done() const { return chunker_ ? chunker_->Done() : done_; }
  /// Overwrites `out`; only before Done().
  void Next(v1::WorkerMessage* out);

 private:
  FromWorker message_;
  std::optional<PartialChunker> chunker_;
  bool done_ = false;
};

/// Reads what one worker sends.
class WorkerMessageReader {
 public:
  /// Nothing while a partial is incomplete. INVALID_ARGUMENT naming the field and why; the reader
  /// may not be used afterwards. Of a Hello of another protocol only the number is read.
  absl::StatusOr<std::optional<FromWorker>> Add(const v1::WorkerMessage& message);

 private:
  PartialAssembler assembler_;
};

void ToWire(const ToWorker& message, v1::CoordinatorMessage* out);
/// INVALID_ARGUMENT naming the field and why.
absl::StatusOr<ToWorker> FromWire(const v1::CoordinatorMessage& message);

}  // namespace strata::wire
