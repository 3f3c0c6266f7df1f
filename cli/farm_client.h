#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/report.h"
#include "common/status.h"
#include "worker/scene/file_source.h"

namespace grpc {
class Channel;
}

namespace strata {

/// Asks a coordinator over strata.v1. Every call blocks; UNAVAILABLE when the server did not answer
/// within five seconds. Thread-safe.
class FarmClient {
 public:
  /// `server` is HOST:PORT.
  static absl::StatusOr<std::unique_ptr<FarmClient>> Dial(const std::string& server, bool insecure);
  /// Over a channel of the same process.
  static std::unique_ptr<FarmClient> Over(std::shared_ptr<grpc::Channel> channel);
  ~FarmClient();

  /// Sends the files of the bundle the server lacks, reading them under `root`, but for those
  /// `elsewhere`; tells of bytes sent and bytes to send.
  absl::Status Upload(const Bundle& bundle, const std::filesystem::path& root,
                      const std::function<void(uint64_t sent, uint64_t total)>& progress,
                      const FilesElsewhere& elsewhere = {});
  /// The same `request_id` gives the same job however often it is sent.
  absl::StatusOr<JobId> Submit(const JobSpec& spec, const std::string& request_id);
  absl::StatusOr<JobStatus> Get(const JobId& job);
  absl::StatusOr<std::vector<JobStatus>> List();
  /// Calls `on_status` at each change, about four times a second at most, until the job is in a
  /// final state (the last call), `on_status` returns false, or the stream breaks.
  absl::Status Watch(const JobId& job, const std::function<bool(const JobStatus&)>& on_status);
  absl::StatusOr<ImageLayers> FetchImage(const JobId& job);
  absl::Status Cancel(const JobId& job);
  absl::Status Pause(const JobId& job);
  absl::Status Resume(const JobId& job);
  absl::Status Retry(const JobId& job);
  absl::Status Delete(const JobId& job);
  absl::Status SetPriority(const JobId& job, int priority);
  absl::StatusOr<std::vector<LogLine>> Logs(const JobId& job);
  absl::StatusOr<std::vector<WorkerStatus>> Workers();
  /// OK when the gRPC health service says SERVING.
  absl::Status Health();

 private:
  struct State;
  explicit FarmClient(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace strata
