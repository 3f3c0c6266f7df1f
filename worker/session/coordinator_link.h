#pragma once

#include "common/messages.h"

namespace strata {

/// The way to the coordinator. Implemented by the gRPC client and by fakes in tests.
class CoordinatorLink {
 public:
  virtual ~CoordinatorLink() = default;
  /// Queues a message; may block while too many bytes wait to be written; any thread.
  virtual void Send(FromWorker message) = 0;
};

}  // namespace strata
