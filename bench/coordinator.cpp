// What the coordinator itself costs, over gRPC on loopback, with workers in another process that
// render nothing: partials merged per second of its CPU time, a thousand idle workers, and how long
// a worker waits between two leases.

#include <spdlog/spdlog.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/farm_client.h"
#include "common/build_info.h"
#include "common/kernel_revision.h"
#include "common/memory.h"
#include "common/sync.h"
#include "common/wire/channel.h"
#include "coordinator/service/server.h"
#include "worker/pbrt/reader.h"
#include "worker/service/worker_connection.h"

namespace strata {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double Since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Of this process, user and system.
double CpuSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double PartialBytes(int64_t pixels, const PixelLayout& layout) {
  return static_cast<double>(pixels) *
         (8.0 * layout.Doubles() + sizeof(uint32_t) + sizeof(uint64_t) + sizeof(uint32_t));
}

struct Options {
  int workers = 4;
  double unit_ms = 0;  ///< What a unit takes to "render".
  int edge = 1024, pieces = 16, tile = 64;
  int idle_workers = 1000;
  double idle_seconds = 20;
};

/// Milliseconds from the end of one unit to the begin of the next, by all workers.
class Gaps {
 public:
  void Add(double ms) {
    MutexLock lock(mutex_);
    gaps_.push_back(ms);
  }
  void Print() {
    MutexLock lock(mutex_);
    if (gaps_.empty()) return;
    std::sort(gaps_.begin(), gaps_.end());
    std::printf("from unit to unit at a worker: median %.3f ms, 99th percentile %.3f, most %.3f\n",
                gaps_[gaps_.size() / 2], gaps_[gaps_.size() * 99 / 100], gaps_.back());
    std::fflush(stdout);
  }

 private:
  Mutex mutex_;
  std::vector<double> gaps_ STRATA_GUARDED_BY(mutex_);
};

/// Answers each unit with the same gray pixels.
class GrayUnits final : public UnitRenderer {
 public:
  GrayUnits(const JobSpec& spec, double unit_ms, Gaps& gaps)
      : layout_(LayoutOf(spec)), unit_ms_(unit_ms), gaps_(gaps) {}

  absl::StatusOr<Partial> Render(const WorkUnit& unit, const std::atomic<bool>&) override {
    if (ended_ != Clock::time_point{}) gaps_.Add(1e3 * Since(ended_));
    std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(unit_ms_));
    Partial partial;
    partial.unit = unit.id;
    partial.pixels = unit.pixels;
    partial.layout = layout_;
    const size_t pixels = static_cast<size_t>(unit.pixels.Pixels());
    partial.values.assign(pixels * static_cast<size_t>(layout_.Doubles()), 0.5);
    for (size_t i = 0; i < pixels; ++i) {
      const uint32_t count = unit.RangeOf(static_cast<int64_t>(i)).Count();
      partial.samples.push_back(count);
      partial.rays.push_back(uint64_t{kReplicates} * count * 5);
    }
    partial.nonfinite.resize(pixels);
    ended_ = Clock::now();
    return partial;
  }

 private:
  PixelLayout layout_;
  double unit_ms_;
  Gaps& gaps_;
  Clock::time_point ended_;
};

class GrayEngine final : public RenderEngine {
 public:
  GrayEngine(double unit_ms, Gaps& gaps) : unit_ms_(unit_ms), gaps_(gaps) {}
  absl::StatusOr<std::shared_ptr<const LoadedScene>> Load(const FileSource&,
                                                          const Bundle&) override {
    return std::make_shared<const LoadedScene>();
  }
  absl::StatusOr<std::unique_ptr<UnitRenderer>> Prepare(std::shared_ptr<const LoadedScene>,
                                                        const JobSpec& spec) override {
    return std::make_unique<GrayUnits>(spec, unit_ms_, gaps_);
  }

 private:
  double unit_ms_;
  Gaps& gaps_;
};

/// A worker's session and its one connection.
struct SimulatedWorker {
  std::unique_ptr<v1::WorkerService::Stub> stub;
  std::unique_ptr<WorkerSession> session;
  std::shared_ptr<WorkerConnection> connection;

  SimulatedWorker(const std::string& server, const fs::path& cache, double unit_ms, Gaps& gaps) {
    stub = v1::WorkerService::NewStub(*wire::Dial(server, false));
    Hello hello;
    hello.build = BuildRevision();
    hello.kernel_revision = kKernelRevision;
    hello.name = cache.filename().string();
    hello.threads = 1;
    session = std::make_unique<WorkerSession>(hello, *FileCache::Open(cache, 1 << 20),
                                              std::make_unique<GrayEngine>(unit_ms, gaps),
                                              [](const absl::Status&) {});
    connection = std::make_shared<WorkerConnection>(*session);
    connection->Start(*stub);
    session->Attach(connection);
  }
  ~SimulatedWorker() {
    connection->Cancel();
    while (!connection->WaitForEnd(std::chrono::milliseconds(1000))) {
    }
    session->Detach();
  }
};

/// The workers' process: reads the coordinator's port from `from`, and works until that closes.
int Work(int from, int workers, double unit_ms, const fs::path& folder) {
  int port = 0;
  if (read(from, &port, sizeof(port)) != sizeof(port)) return 1;
  Gaps gaps;
  {
    std::vector<std::unique_ptr<SimulatedWorker>> all;
    for (int i = 0; i < workers; ++i) {
      all.push_back(std::make_unique<SimulatedWorker>(
          "127.0.0.1:" + std::to_string(port), folder / ("w" + std::to_string(i)), unit_ms, gaps));
    }
    char end;
    while (read(from, &end, 1) > 0) {
    }
  }
  if (unit_ms > 0) gaps.Print();
  return 0;
}

/// A folder that goes with it.
struct ScratchFolder {
  fs::path path;
  ScratchFolder() {
    std::string name = (fs::temp_directory_path() / "strata-coordinator-XXXXXX").string();
    path = mkdtemp(name.data()) ? name : "";
  }
  ~ScratchFolder() { fs::remove_all(path); }
};

/// A coordinator here and workers in a process of their own, which is made before gRPC is.
class SimulatedFarm {
 public:
  SimulatedFarm(int workers, double unit_ms) {
    int ends[2];
    if (pipe(ends) != 0) std::abort();
    child_ = fork();
    if (child_ == 0) {
      close(ends[1]);
      _exit(Work(ends[0], workers, unit_ms, folder_.path));
    }
    close(ends[0]);
    to_workers_ = ends[1];
    ServerOptions options;
    options.listen = "127.0.0.1:0";
    options.farm.state_dir = folder_.path / "state";
    auto server = CoordinatorServer::Start(options);
    if (!server.ok()) {
      std::fprintf(stderr, "%s\n", server.status().ToString().c_str());
      std::exit(2);
    }
    server_ = *std::move(server);
    client_ = FarmClient::Over(server_->InProcessChannel());
    const int port = server_->port();
    if (write(to_workers_, &port, sizeof(port)) != sizeof(port)) std::abort();
  }
  ~SimulatedFarm() {
    close(to_workers_);
    waitpid(child_, nullptr, 0);
  }

  FarmClient& client() { return *client_; }

  void WaitForWorkers(size_t count) {
    while (client_->Workers()->size() < count)
      std::this_thread::sleep_for(std::chrono::milliseconds(200));
  }

  /// Until it is done.
  absl::Status RunJob(JobSpec spec) {
    std::ofstream(folder_.path / "scene.pbrt") << "WorldBegin\n";
    STRATA_ASSIGN_OR_RETURN(
        spec.bundle, MakeBundle(DirectorySource(folder_.path), "scene.pbrt", {"scene.pbrt"}));
    STRATA_RETURN_IF_ERROR(client_->Upload(spec.bundle, folder_.path, [](uint64_t, uint64_t) {}));
    STRATA_ASSIGN_OR_RETURN(const JobId job, client_->Submit(spec, "bench"));
    return client_->Watch(job, [](const JobStatus&) { return true; });
  }

 private:
  ScratchFolder folder_;
  pid_t child_ = 0;
  int to_workers_ = -1;
  std::unique_ptr<CoordinatorServer> server_;
  std::unique_ptr<FarmClient> client_;
};

JobSpec SpecOf(const Options& options) {
  JobSpec spec;
  spec.width = spec.height = options.edge;
  spec.crop = {0, 0, options.edge, options.edge};
  spec.tile = options.tile;
  spec.spp = static_cast<uint32_t>(options.pieces) * 32 * kReplicates;
  return spec;
}

int Merge(const Options& options) {
  SimulatedFarm farm(options.workers, 0);
  farm.WaitForWorkers(static_cast<size_t>(options.workers));
  const JobSpec spec = SpecOf(options);
  const double cpu = CpuSeconds();
  const Clock::time_point start = Clock::now();
  if (const absl::Status status = farm.RunJob(spec); !status.ok()) {
    std::fprintf(stderr, "%s\n", status.ToString().c_str());
    return 2;
  }
  const double seconds = Since(start), used = CpuSeconds() - cpu;
  const double bytes = options.pieces * PartialBytes(spec.crop.Pixels(), LayoutOf(spec));
  const int tiles = (options.edge + options.tile - 1) / options.tile;
  std::printf(
      "%.0f MB of partials from %d workers in %.2f s, %.2f s of CPU: %.0f MB/s per core, %.0f us "
      "for "
      "a partial\n",
      bytes * 1e-6, options.workers, seconds, used, bytes * 1e-6 / used,
      1e6 * used / (tiles * tiles * options.pieces));
  return 0;
}

int Idle(const Options& options) {
  SimulatedFarm farm(options.idle_workers, 0);
  farm.WaitForWorkers(static_cast<size_t>(options.idle_workers));
  std::this_thread::sleep_for(std::chrono::seconds(5));
  const double cpu = CpuSeconds();
  const Clock::time_point start = Clock::now();
  std::this_thread::sleep_for(std::chrono::duration<double>(options.idle_seconds));
  std::printf("%d idle workers: %.2f %% of a core\n", options.idle_workers,
              100 * (CpuSeconds() - cpu) / Since(start));
  return 0;
}

int Gap(const Options& options) {
  SimulatedFarm farm(1, options.unit_ms);
  farm.WaitForWorkers(1);
  const absl::Status status = farm.RunJob(SpecOf(options));
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.ToString().c_str());
  return 2;
}

int Main(int argc, char** argv) {
  CLI::App app("What the coordinator itself costs, with workers that render nothing");
  app.require_subcommand(1);
  Options options;
  CLI::App* merge = app.add_subcommand("merge", "partials received and merged per CPU second");
  merge->add_option("--workers", options.workers);
  merge->add_option("--edge", options.edge, "of the square frame in pixels");
  merge->add_option("--tile", options.tile, "edge in pixels; small ones show what a partial costs");
  merge->add_option("--pieces", options.pieces, "partials of each pixel");
  CLI::App* idle = app.add_subcommand("idle", "CPU of a coordinator whose workers have no work");
  idle->add_option("--workers", options.idle_workers);
  idle->add_option("--seconds", options.idle_seconds);
  CLI::App* gap = app.add_subcommand("gap", "time a worker waits from unit to unit");
  gap->add_option("--unit-ms", options.unit_ms, "that a unit takes")->default_val(20.0);
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::warn);
  if (*merge) return Merge(options);
  if (*idle) return Idle(options);
  options.edge = 256;
  options.pieces = 32;
  return Gap(options);
}

}  // namespace
}  // namespace strata

int main(int argc, char** argv) {
  strata::KeepFreedMemory();  // As strata-coordinator does.
  return strata::Main(argc, argv);
}
