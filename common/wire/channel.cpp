#include "common/wire/channel.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include "common/net_address.h"

namespace strata::wire {

absl::StatusOr<std::shared_ptr<grpc::Channel>> Dial(const std::string& server, bool insecure) {
  STRATA_ASSIGN_OR_RETURN(const NetAddress address, ParseNetAddress(server));
  if (!insecure && !IsLoopback(address.host)) {
    return absl::FailedPreconditionError(
        absl::StrCat(server,
                     ": is another machine, and connections are not encrypted yet; add "
                     "--insecure if the network between is trusted"));
  }
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(kMaxAnswerBytes);
  arguments.SetMaxSendMessageSize(-1);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kKeepaliveMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kKeepaliveTimeoutMs);
  arguments.SetInt(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, 200);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, 1000);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, 5000);
  // Each channel has its own connection: one that broke must not be found in another's cache.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(server, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace strata::wire
