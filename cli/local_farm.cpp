#include "cli/local_farm.h"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include "coordinator/service/server.h"
#include "worker/service/worker_client.h"

namespace strata {

namespace {

/// Coordinator and workers log for operators; here a person waits for an image. What concerns a job
/// is in the job's own log too, so only faults are let through, and never to stdout.
void LogFaultsAlone() {
  spdlog::set_default_logger(std::make_shared<spdlog::logger>(
      "strata", std::make_shared<spdlog::sinks::stderr_sink_mt>()));
  spdlog::set_level(spdlog::level::err);
}

}  // namespace

LocalFarm::LocalFarm(TemporaryDirectory directory) : directory_(std::move(directory)) {}
LocalFarm::~LocalFarm() = default;

absl::StatusOr<std::unique_ptr<LocalFarm>> LocalFarm::Start(int workers, int threads) {
  LogFaultsAlone();
  STRATA_ASSIGN_OR_RETURN(TemporaryDirectory directory, TemporaryDirectory::Create());
  std::unique_ptr<LocalFarm> farm(new LocalFarm(std::move(directory)));
  ServerOptions server;
  server.farm.state_dir = farm->directory_.path() / "state";
  STRATA_ASSIGN_OR_RETURN(farm->coordinator_, CoordinatorServer::Start(std::move(server)));
  farm->client_ = FarmClient::Over(farm->coordinator_->InProcessChannel());
  for (int i = 0; i < workers; ++i) {
    WorkerOptions worker;
    worker.name = absl::StrCat("local-", i + 1);
    worker.cache_dir = farm->directory_.path() / worker.name;
    worker.threads = static_cast<uint32_t>(threads);
    STRATA_ASSIGN_OR_RETURN(
        farm->workers_.emplace_back(),
        InProcessWorker::Start(farm->coordinator_->InProcessChannel(), std::move(worker)));
  }
  return farm;
}

}  // namespace strata
