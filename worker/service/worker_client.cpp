#include "worker/service/worker_client.h"

#include <grpcpp/channel.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <thread>
#include <utility>

#include "common/build_info.h"
#include "common/kernel_revision.h"
#include "worker/integrator/render.h"
#include "worker/service/health_file.h"
#include "worker/service/worker_connection.h"

namespace strata {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFirstPause(200), kLongestPause(5000);
/// How long a coordinator may take to end a connection that this side closes, counted from the last
/// write that went out: what is finished may take longer than that to send.
constexpr milliseconds kCloseGrace(10'000);

std::string HostName() {
  char name[256] = {};
  return gethostname(name, sizeof(name) - 1) == 0 ? name : "worker";
}

Hello MakeHello(const WorkerOptions& options) {
  Hello hello;
  hello.build = BuildRevision();
  hello.kernel_revision = kKernelRevision;
  hello.libraries = LibraryVersions();
  hello.isa = "avx2";
  hello.traced = TracedDigest();
  hello.name = options.name.empty() ? HostName() : options.name;
  hello.tags = options.tags;
  hello.threads = options.threads;
  hello.memory_limit = options.memory_limit;
  return hello;
}

}  // namespace

struct WorkerClient::State {
  std::unique_ptr<v1::WorkerService::Stub> stub;
  std::unique_ptr<HealthFile> health;
  Mutex mutex;
  CondVar changed;
  std::shared_ptr<WorkerConnection> connection STRATA_GUARDED_BY(mutex);
  std::optional<absl::Status> leave STRATA_GUARDED_BY(mutex);  ///< What the session said.
  bool draining STRATA_GUARDED_BY(mutex) = false;
  bool stopping STRATA_GUARDED_BY(mutex) = false;
  std::unique_ptr<WorkerSession> session;  ///< Last: its threads call Leave.

  void Leave(const absl::Status& status);
  std::shared_ptr<WorkerConnection> Connect();
  absl::Status WaitForEnd(WorkerConnection& connection);
  std::optional<absl::Status> Verdict(const absl::Status& end);
  void Pause(milliseconds pause);
};

absl::StatusOr<std::unique_ptr<WorkerClient>> WorkerClient::Create(
    std::shared_ptr<grpc::Channel> channel, WorkerOptions options) {
  STRATA_ASSIGN_OR_RETURN(std::unique_ptr<FileCache> cache,
                          FileCache::Open(options.cache_dir, options.cache_bytes));
  auto state = std::make_unique<State>();
  state->stub = v1::WorkerService::NewStub(std::move(channel));
  state->health = std::make_unique<HealthFile>(options.health_file);
  state->session = std::make_unique<WorkerSession>(
      MakeHello(options), std::move(cache), NewPathTracingEngine(static_cast<int>(options.threads)),
      [raw = state.get()](const absl::Status& status) { raw->Leave(status); });
  return std::unique_ptr<WorkerClient>(new WorkerClient(std::move(state)));
}

WorkerClient::WorkerClient(std::unique_ptr<State> state) : state_(std::move(state)) {}
WorkerClient::~WorkerClient() = default;

absl::Status WorkerClient::Run() {
  milliseconds pause = kFirstPause;
  while (std::shared_ptr<WorkerConnection> connection = state_->Connect()) {
    const absl::Status end = state_->WaitForEnd(*connection);
    if (state_->session->Welcomed()) pause = kFirstPause;
    state_->session->Detach();
    if (std::optional<absl::Status> verdict = state_->Verdict(end)) return *verdict;
    state_->health->Write(HealthFile::kConnecting);
    state_->Pause(pause);
    pause = std::min(2 * pause, kLongestPause);
  }
  return absl::OkStatus();
}

/// Null when there is nothing left to connect for.
std::shared_ptr<WorkerConnection> WorkerClient::State::Connect() {
  auto next = std::make_shared<WorkerConnection>(*session);
  {
    MutexLock lock(mutex);
    if (stopping || draining) return nullptr;
    connection = next;
    leave.reset();
    next->Start(*stub);
  }
  session->Attach(next);
  return next;
}

absl::Status WorkerClient::State::WaitForEnd(WorkerConnection& open) {
  std::optional<std::chrono::steady_clock::time_point> left;
  while (true) {
    if (std::optional<absl::Status> end = open.WaitForEnd(milliseconds(1000))) return *end;
    if (session->Welcomed()) health->Write(HealthFile::kConnected);
    const auto now = std::chrono::steady_clock::now();
    MutexLock lock(mutex);
    if (leave && !left) left = now;
    if (left && now - std::max(*left, open.LastWrite()) > kCloseGrace) open.Cancel();
  }
}

/// What Run returns now that a connection ended; nothing to connect again.
std::optional<absl::Status> WorkerClient::State::Verdict(const absl::Status& end) {
  MutexLock lock(mutex);
  connection.reset();
  if (stopping) return absl::OkStatus();
  if (leave && !absl::IsUnavailable(*leave)) return *leave;
  const absl::Status& why = leave ? *leave : end;
  spdlog::warn("no connection to the coordinator: {}; trying again", std::string(why.message()));
  if (draining) return absl::OkStatus();
  return std::nullopt;
}

void WorkerClient::State::Pause(milliseconds pause) {
  const auto until = std::chrono::steady_clock::now() + pause;
  MutexLock lock(mutex);
  while (!stopping && !draining && changed.WaitUntil(mutex, until)) {
  }
}

void WorkerClient::State::Leave(const absl::Status& status) {
  MutexLock lock(mutex);
  leave = status;
  if (connection) connection->Close();
}

void WorkerClient::Drain() {
  {
    MutexLock lock(state_->mutex);
    state_->draining = true;
    // One that was not welcomed yet holds nothing.
    if (state_->connection && !state_->session->Welcomed()) state_->connection->Cancel();
  }
  state_->changed.NotifyAll();
  state_->session->Drain();
}

void WorkerClient::Stop() {
  {
    MutexLock lock(state_->mutex);
    state_->stopping = true;
    if (state_->connection) state_->connection->Cancel();
  }
  state_->changed.NotifyAll();
}

struct InProcessWorker::State {
  std::unique_ptr<WorkerClient> client;
  std::thread thread;
};

absl::StatusOr<std::unique_ptr<InProcessWorker>> InProcessWorker::Start(
    std::shared_ptr<grpc::Channel> channel, WorkerOptions options) {
  auto state = std::make_unique<State>();
  STRATA_ASSIGN_OR_RETURN(state->client,
                          WorkerClient::Create(std::move(channel), std::move(options)));
  state->thread = std::thread([client = state->client.get()] {
    const absl::Status status = client->Run();
    if (!status.ok()) spdlog::error("worker: {}", std::string(status.message()));
  });
  return std::unique_ptr<InProcessWorker>(new InProcessWorker(std::move(state)));
}

InProcessWorker::InProcessWorker(std::unique_ptr<State> state) : state_(std::move(state)) {}

InProcessWorker::~InProcessWorker() {
  state_->client->Stop();
  state_->thread.join();
}

}  // namespace strata
