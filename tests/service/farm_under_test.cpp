#include "tests/service/farm_under_test.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "worker/pbrt/reader.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

TestScene SmallJob(const fs::path& root, const std::string& file) {
  const DirectorySource source(root);
  const absl::StatusOr<PbrtScene> scene = ReadPbrt(source, file);
  EXPECT_TRUE(scene.ok()) << scene.status().message();
  const absl::StatusOr<Bundle> bundle = MakeBundle(source, file, scene->files);
  EXPECT_TRUE(bundle.ok()) << bundle.status().message();
  TestScene test{root, {}};
  test.spec.name = file;
  test.spec.bundle = *bundle;
  test.spec.width = 48;
  test.spec.height = 40;
  test.spec.crop = {0, 0, 48, 40};
  test.spec.filter = scene->scene.defaults.filter;
  test.spec.spp = 16;
  test.spec.max_depth = 5;
  return test;
}

}  // namespace

std::optional<TestScene> SharedScene(const std::string& name) {
  const char* shared = std::getenv("STRATA_SHARED");
  const fs::path root = fs::path(shared != nullptr ? shared : STRATA_SOURCE_DIR "/../shared") /
                        "scenes" / "pbrt" / name;
  if (!fs::exists(root / "scene.pbrt")) return std::nullopt;
  return SmallJob(root, "scene.pbrt");
}

TestScene OwnScene(const std::string& path) {
  const fs::path file = fs::path(STRATA_SOURCE_DIR) / "scenes" / path;
  return SmallJob(file.parent_path(), file.filename().string());
}

absl::StatusOr<JobId> SubmitJob(FarmClient& client, const TestScene& scene) {
  static int request = 0;
  STRATA_RETURN_IF_ERROR(client.Upload(scene.spec.bundle, scene.root, nullptr));
  return client.Submit(scene.spec, absl::StrCat("test-", getpid(), "-", ++request));
}

absl::StatusOr<JobStatus> AwaitEnd(FarmClient& client, const JobId& job) {
  JobStatus last;
  STRATA_RETURN_IF_ERROR(client.Watch(job, [&last](const JobStatus& status) {
    last = status;
    return true;
  }));
  return last;
}

absl::StatusOr<Digest> RunJob(FarmClient& client, const TestScene& scene) {
  STRATA_ASSIGN_OR_RETURN(const JobId job, SubmitJob(client, scene));
  STRATA_ASSIGN_OR_RETURN(const JobStatus status, AwaitEnd(client, job));
  if (status.state != JobState::kDone) return absl::AbortedError(status.message);
  return status.result;
}

InProcessFarm::InProcessFarm(int workers, uint32_t threads) {
  ServerOptions options;
  options.farm.state_dir = directory_ / "state";
  auto server = CoordinatorServer::Start(options);
  EXPECT_TRUE(server.ok()) << server.status().message();
  server_ = *std::move(server);
  for (int i = 0; i < workers; ++i) {
    WorkerOptions worker;
    worker.cache_dir = directory_ / "cache";  // Shared: caches may be.
    worker.threads = threads;
    worker.name = absl::StrCat("worker-", i);
    auto started = InProcessWorker::Start(server_->InProcessChannel(), worker);
    EXPECT_TRUE(started.ok()) << started.status().message();
    workers_.push_back(*std::move(started));
  }
  client_ = FarmClient::Over(server_->InProcessChannel());
}

TcpFarm::TcpFarm(double silence_s) : silence_s_(silence_s) {
  StartCoordinator();
  auto client = FarmClient::Dial(server(), false);
  EXPECT_TRUE(client.ok()) << client.status().message();
  client_ = *std::move(client);
}

std::string TcpFarm::server() const { return absl::StrCat("127.0.0.1:", port_); }

void TcpFarm::StartCoordinator() {
  const fs::path port_file = directory_ / "port";
  fs::remove(port_file);
  coordinator_ = std::make_unique<Process>(
      "strata-coordinator",
      std::vector<std::string>{"--listen", server(), "--state", directory_ / "state", "--port-file",
                               port_file, "--silence", std::to_string(silence_s_)},
      directory_ / "coordinator.log");
  ASSERT_TRUE(Eventually([&] { return fs::exists(port_file) || !coordinator_->Running(); }));
  std::ifstream(port_file) >> port_;
  ASSERT_NE(port_, 0) << Logs();
}

Process& TcpFarm::StartWorker(uint32_t threads) {
  const std::string name = absl::StrCat("worker-", workers_.size());
  workers_.push_back(std::make_unique<Process>(
      "strata-worker",
      std::vector<std::string>{"--server", server(), "--cache", directory_ / ("cache-" + name),
                               "--threads", std::to_string(threads), "--name", name,
                               "--health-file", directory_ / (name + ".health")},
      directory_ / (name + ".log")));
  return *workers_.back();
}

bool TcpFarm::AwaitWorkers(size_t count) {
  return Eventually([&] {
    const absl::StatusOr<std::vector<WorkerStatus>> workers = client_->Workers();
    return workers.ok() && static_cast<size_t>(std::count_if(
                               workers->begin(), workers->end(), [](const WorkerStatus& worker) {
                                 return worker.state == "idle" || worker.state == "busy";
                               })) == count;
  });
}

std::string TcpFarm::Logs() const {
  std::ostringstream text;
  for (size_t i = 0; i <= workers_.size(); ++i) {
    const std::string name =
        i == workers_.size() ? std::string("coordinator") : absl::StrCat("worker-", i);
    text << name << ":\n" << std::ifstream(directory_ / (name + ".log")).rdbuf() << "\n";
  }
  return text.str();
}

}  // namespace strata
