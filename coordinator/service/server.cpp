#include "coordinator/service/server.h"

#include <grpcpp/ext/proto_server_reflection_plugin.h>
#include <grpcpp/health_check_service_interface.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>

#include <thread>
#include <utility>

#include "common/build_info.h"
#include "common/kernel_revision.h"
#include "common/net_address.h"
#include "common/sync.h"
#include "common/wire/channel.h"
#include "coordinator/service/farm_service.h"
#include "coordinator/service/worker_stream.h"

namespace strata {
namespace {

constexpr auto kTick = std::chrono::milliseconds(100);
constexpr auto kStopGrace = std::chrono::milliseconds(500);

/// Calls Farm::Tick until destroyed.
class FarmClock {
 public:
  explicit FarmClock(Farm& farm) : farm_(farm), thread_([this] { Run(); }) {}
  ~FarmClock() {
    {
      MutexLock lock(mutex_);
      stopping_ = true;
    }
    changed_.NotifyAll();
    thread_.join();
  }

 private:
  void Run() {
    while (true) {
      const SteadyTime now = std::chrono::steady_clock::now();
      farm_.Tick(now);
      MutexLock lock(mutex_);
      while (!stopping_ && changed_.WaitUntil(mutex_, now + kTick)) {
      }
      if (stopping_) return;
    }
  }

  Farm& farm_;
  Mutex mutex_;
  CondVar changed_;
  bool stopping_ STRATA_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

absl::Status CheckListen(const std::string& listen, bool insecure) {
  STRATA_ASSIGN_OR_RETURN(const NetAddress address, ParseNetAddress(listen));
  if (insecure || IsLoopback(address.host)) return absl::OkStatus();
  return absl::FailedPreconditionError(
      absl::StrCat("--listen ", listen,
                   ": other machines could reach it, and TLS and tokens are not there yet; listen "
                   "on 127.0.0.1, or add --insecure if the network is trusted"));
}

void Configure(grpc::ServerBuilder& builder) {
  builder.SetMaxReceiveMessageSize(wire::kMaxRequestBytes);
  builder.SetMaxSendMessageSize(-1);
  // Two coordinators on one port would each get some of the workers.
  builder.AddChannelArgument(GRPC_ARG_ALLOW_REUSEPORT, 0);
  // gRPC would probe the bandwidth with a ping for each heartbeat, which made up a third of what
  // idle workers cost. In the place of a window that is found so, one that a fast link can fill.
  builder.AddChannelArgument(GRPC_ARG_HTTP2_BDP_PROBE, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_STREAM_LOOKAHEAD_BYTES, 4 << 20);
  // Half-open connections are found by pings; peers may ping as often.
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIME_MS, wire::kServerKeepaliveMs);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, wire::kKeepaliveTimeoutMs);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MAX_PINGS_WITHOUT_DATA, 0);
  builder.AddChannelArgument(GRPC_ARG_HTTP2_MIN_RECV_PING_INTERVAL_WITHOUT_DATA_MS,
                             wire::kKeepaliveMs / 2);
  builder.AddChannelArgument(GRPC_ARG_KEEPALIVE_PERMIT_WITHOUT_CALLS, 1);
}

}  // namespace

/// Members end in the reverse order: gRPC's server, then the streams' threads, the clock, the farm.
struct CoordinatorServer::State {
  std::unique_ptr<Farm> farm;
  std::unique_ptr<FarmClock> clock;
  std::unique_ptr<FarmServiceImpl> farm_service;
  std::unique_ptr<WorkerServiceImpl> worker_service;
  std::unique_ptr<grpc::Server> server;
  int port = 0;
};

CoordinatorServer::CoordinatorServer(std::unique_ptr<State> state) : state_(std::move(state)) {}

CoordinatorServer::~CoordinatorServer() { Stop(); }

absl::StatusOr<std::unique_ptr<CoordinatorServer>> CoordinatorServer::Start(ServerOptions options) {
  if (!options.listen.empty()) {
    STRATA_RETURN_IF_ERROR(CheckListen(options.listen, options.insecure));
  }
  options.farm.build = BuildRevision();
  options.farm.kernel_revision = kKernelRevision;
  auto state = std::make_unique<State>();
  std::unique_ptr<JobStore> store = NewMemoryJobStore(options.farm.state_dir / "last-job");
  STRATA_ASSIGN_OR_RETURN(state->farm, Farm::Create(std::move(options.farm), std::move(store)));
  state->farm_service = std::make_unique<FarmServiceImpl>(*state->farm);
  state->worker_service = std::make_unique<WorkerServiceImpl>(*state->farm);

  grpc::EnableDefaultHealthCheckService(true);
  grpc::reflection::InitProtoReflectionServerBuilderPlugin();
  grpc::ServerBuilder builder;
  Configure(builder);
  if (!options.listen.empty()) {
    builder.AddListeningPort(options.listen, grpc::InsecureServerCredentials(), &state->port);
  }
  builder.RegisterService(state->farm_service.get());
  builder.RegisterService(state->worker_service.get());
  state->server = builder.BuildAndStart();
  if (!state->server || (!options.listen.empty() && state->port == 0)) {
    return absl::UnavailableError(absl::StrCat(
        "--listen ", options.listen, ": cannot be bound; is another coordinator running there?"));
  }
  state->server->GetHealthCheckService()->SetServingStatus(true);
  state->clock = std::make_unique<FarmClock>(*state->farm);
  return std::unique_ptr<CoordinatorServer>(new CoordinatorServer(std::move(state)));
}

int CoordinatorServer::port() const { return state_->port; }

std::shared_ptr<grpc::Channel> CoordinatorServer::InProcessChannel() {
  grpc::ChannelArguments arguments;
  arguments.SetMaxReceiveMessageSize(wire::kMaxAnswerBytes);
  arguments.SetMaxSendMessageSize(-1);
  return state_->server->InProcessChannel(arguments);
}

void CoordinatorServer::Stop() {
  if (!state_->server) return;
  state_->server->GetHealthCheckService()->SetServingStatus(false);
  state_->server->Shutdown(std::chrono::system_clock::now() + kStopGrace);
  state_->server.reset();
  state_->worker_service.reset();
  state_->farm_service.reset();
  state_->clock.reset();
}

}  // namespace strata
