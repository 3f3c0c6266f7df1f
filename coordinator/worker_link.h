#pragma once

#include "common/messages.h"

namespace strata {

/// The way to one worker. Implemented by the gRPC service and by fakes in tests.
class WorkerLink {
 public:
  virtual ~WorkerLink() = default;
  /// Queues a message; never blocks, never calls back into the farm, may be called from any thread.
  /// Messages for a link that broke are dropped.
  virtual void Send(ToWorker message) = 0;
  /// Ends the connection once what is queued is written.
  virtual void Close() = 0;
};

}  // namespace strata
