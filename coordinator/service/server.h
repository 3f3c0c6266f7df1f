#pragma once

#include <memory>
#include <string>

#include "coordinator/farm.h"

namespace grpc {
class Channel;
}

namespace strata {

struct ServerOptions {
  FarmOptions farm;       ///< build and kernel_revision are filled in by Start.
  std::string listen;     ///< HOST:PORT, port 0 for a free one; empty: reachable in-process alone.
  bool insecure = false;  ///< Listen beyond loopback without TLS and tokens.
};

/// A farm behind strata.v1: the client's and the worker's service, gRPC health and reflection, and
/// the clock that drives the farm.
class CoordinatorServer {
 public:
  /// FAILED_PRECONDITION when `listen` is reachable from other machines and `insecure` is not set;
  /// INVALID_ARGUMENT when it is no address; UNAVAILABLE when it cannot be bound.
  static absl::StatusOr<std::unique_ptr<CoordinatorServer>> Start(ServerOptions options);
  /// Stops.
  ~CoordinatorServer();

  /// The bound port; 0 when it listens nowhere.
  int port() const;
  /// To the same services without a network. Usable until Stop.
  std::shared_ptr<grpc::Channel> InProcessChannel();
  /// Health answers NOT_SERVING, streams are ended, calls under way get half a second.
  void Stop();

 private:
  struct State;
  explicit CoordinatorServer(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace strata
