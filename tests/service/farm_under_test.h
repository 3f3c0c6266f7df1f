#pragma once

#include <memory>
#include <string>
#include <vector>

#include "cli/farm_client.h"
#include "coordinator/service/server.h"
#include "tests/service/process.h"
#include "worker/service/worker_client.h"

namespace strata {

/// A scene of the project, or of the shared folder, with the spec of a small job for it.
struct TestScene {
  std::filesystem::path root;
  JobSpec spec;
};

/// `name` of the shared scenes' folder; nothing when it is not there.
std::optional<TestScene> SharedScene(const std::string& name);
/// FOLDER/FILE of the project's own scenes.
TestScene OwnScene(const std::string& path);

/// The digest of the job's result, or why there is none.
absl::StatusOr<Digest> RunJob(FarmClient& client, const TestScene& scene);
absl::StatusOr<JobId> SubmitJob(FarmClient& client, const TestScene& scene);
/// Follows the job to its end.
absl::StatusOr<JobStatus> AwaitEnd(FarmClient& client, const JobId& job);

/// Everything in this process.
class InProcessFarm {
 public:
  InProcessFarm(int workers, uint32_t threads);
  FarmClient& client() { return *client_; }

 private:
  ScratchDirectory directory_;
  std::unique_ptr<CoordinatorServer> server_;
  std::vector<std::unique_ptr<InProcessWorker>> workers_;
  std::unique_ptr<FarmClient> client_;
};

/// Processes over TCP on loopback.
class TcpFarm {
 public:
  /// `silence_s`: after so long the leases of a silent worker go to others.
  explicit TcpFarm(double silence_s = 10);

  FarmClient& client() { return *client_; }
  Process& coordinator() { return *coordinator_; }
  std::string server() const;
  /// On the port of the first one.
  void StartCoordinator();
  Process& StartWorker(uint32_t threads);
  /// Waits until `count` workers are idle or busy.
  bool AwaitWorkers(size_t count);
  /// What the processes printed.
  std::string Logs() const;

 private:
  const double silence_s_;
  ScratchDirectory directory_;
  int port_ = 0;
  std::unique_ptr<Process> coordinator_;
  std::vector<std::unique_ptr<Process>> workers_;
  std::unique_ptr<FarmClient> client_;
};

}  // namespace strata
