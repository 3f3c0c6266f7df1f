#pragma once

#include <grpcpp/channel.h>

#include <memory>
#include <string>

#include "common/status.h"

namespace strata::wire {

/// Answers to a client or worker may be this large: a lease with a range for each pixel of several
/// 1024 x 1024 tiles. The peer is the coordinator one chose to trust.
inline constexpr int kMaxAnswerBytes = 256 << 20;
/// Requests to a coordinator may be this large: a job of 65536 files.
inline constexpr int kMaxRequestBytes = 16 << 20;
/// A coordinator that does not answer a ping within the second time is taken for gone.
inline constexpr int kKeepaliveMs = 20'000, kKeepaliveTimeoutMs = 10'000;
/// The coordinator pings less: of workers it hears by their heartbeats.
inline constexpr int kServerKeepaliveMs = 60'000;

/// A channel to HOST:PORT; does not wait for the connection. INVALID_ARGUMENT when `server` is no
/// address; FAILED_PRECONDITION when it is another machine and `insecure` is not set.
absl::StatusOr<std::shared_ptr<grpc::Channel>> Dial(const std::string& server, bool insecure);

}  // namespace strata::wire
