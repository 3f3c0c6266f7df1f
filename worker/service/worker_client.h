#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "common/status.h"

namespace grpc {
class Channel;
}

namespace strata {

struct WorkerOptions {
  std::filesystem::path cache_dir;            ///< Files of scenes, kept between runs.
  uint64_t cache_bytes = uint64_t{32} << 30;  ///< Oldest files go when it holds more.
  uint32_t threads = 1;                       ///< 1 to 4096.
  std::string name;                           ///< For people; the host's name if empty.
  std::vector<std::string> tags;
  uint64_t memory_limit = 0;          ///< Bytes; 0: none.
  std::filesystem::path health_file;  ///< The link's state for CheckHealthFile; empty: none.
};

/// One worker over gRPC: dials, reconnects with growing pauses, runs its session.
class WorkerClient {
 public:
  /// UNAVAILABLE or RESOURCE_EXHAUSTED when the cache cannot be used.
  static absl::StatusOr<std::unique_ptr<WorkerClient>> Create(
      std::shared_ptr<grpc::Channel> channel, WorkerOptions options);
  ~WorkerClient();

  /// Serves until drained or stopped (OK) or refused for good (FAILED_PRECONDITION and why). A
  /// coordinator that is not there yet, or goes away, is waited for.
  absl::Status Run();
  /// Finish what is held, then leave. Any thread, not a signal handler.
  void Drain();
  /// Leave at once. Any thread, not a signal handler.
  void Stop();

 private:
  struct State;
  explicit WorkerClient(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// A worker on a thread of its own, for `strata render`.
class InProcessWorker {
 public:
  static absl::StatusOr<std::unique_ptr<InProcessWorker>> Start(
      std::shared_ptr<grpc::Channel> channel, WorkerOptions options);
  /// Stops and waits for it.
  ~InProcessWorker();

 private:
  struct State;
  explicit InProcessWorker(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

/// OK when the worker that writes `file` was connected in the last half minute.
absl::Status CheckHealthFile(const std::filesystem::path& file);

}  // namespace strata
