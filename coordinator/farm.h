#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/messages.h"
#include "common/report.h"
#include "common/status.h"
#include "coordinator/file_store.h"
#include "coordinator/job_store.h"
#include "coordinator/steady_time.h"
#include "coordinator/worker_link.h"

namespace strata {

struct FarmOptions {
  std::filesystem::path state_dir;  ///< Films and uploaded files live here.
  std::string build;                ///< The coordinator's own revision.
  uint32_t kernel_revision = 0;     ///< Workers must match, for reproducible jobs.
  std::chrono::milliseconds heartbeat{6000};
  std::chrono::milliseconds silence{10000};  ///< After which a worker's leases go to others.
  uint32_t max_unit_failures = 3;  ///< Workers a unit may fail or kill before its job fails.
};

/// The coordinator without a network: jobs, plans, leases, merging. Thread-safe; time enters only
/// through Tick and the `now` arguments, so that tests need no clock.
class Farm {
 public:
  /// FAILED_PRECONDITION when another farm uses the state directory.
  static absl::StatusOr<std::unique_ptr<Farm>> Create(FarmOptions options,
                                                      std::unique_ptr<JobStore> store);
  ~Farm();

  // ---- files, by content ----
  std::vector<Digest> MissingFiles(const std::vector<Digest>& digests) const;
  /// Opens an upload; FileUpload::Append and Finish (which verifies the digest) fill it.
  using FileUpload = FileStore::Upload;
  absl::StatusOr<std::unique_ptr<FileUpload>> BeginUpload(const Digest& digest, uint64_t bytes);

  // ---- jobs ----
  /// INVALID_ARGUMENT for a bad spec; FAILED_PRECONDITION when a file has not been uploaded.
  absl::StatusOr<JobId> Submit(const JobSpec& spec, const std::string& request_id, SteadyTime now);
  absl::StatusOr<JobStatus> Get(const JobId& job) const;
  std::vector<JobStatus> List() const;
  absl::Status Cancel(const JobId& job, SteadyTime now);
  absl::Status Pause(const JobId& job, SteadyTime now);
  absl::Status Resume(const JobId& job, SteadyTime now);
  /// A failed or cancelled job starts again; what is merged stays.
  absl::Status Retry(const JobId& job, SteadyTime now);
  /// Final jobs only; FAILED_PRECONDITION otherwise.
  absl::Status Delete(const JobId& job);
  absl::Status SetPriority(const JobId& job, int priority, SteadyTime now);
  absl::StatusOr<std::vector<LogLine>> Logs(const JobId& job) const;
  /// The image as merged so far.
  absl::StatusOr<ImageLayers> Image(const JobId& job) const;

  /// `on_change` is called from Tick and from state changes with the job's status, without locks
  /// held, at most four times a second and once for the end, which is the last call. Returns a
  /// handle for Unsubscribe, after which no further call starts.
  absl::StatusOr<uint64_t> Subscribe(const JobId& job,
                                     std::function<void(const JobStatus&)> on_change);
  void Unsubscribe(uint64_t handle);

  // ---- workers ----
  std::vector<WorkerStatus> Workers(SteadyTime now) const;
  /// Answers with Welcome or Refusal over the link; returns the worker's id either way.
  std::string Connect(const Hello& hello, std::shared_ptr<WorkerLink> link, SteadyTime now);
  /// One message of a connected worker. A result is merged in here, by the calling thread, and the
  /// call returns when it is: who reads a stream re-arms only then.
  void Receive(const std::string& worker, FromWorker message, SteadyTime now);
  void Disconnect(const std::string& worker, SteadyTime now);
  /// Ask a worker to finish what it holds and leave.
  absl::Status Drain(const std::string& worker);

  /// Expires leases, publishes progress, hands out work. Call about ten times a second.
  void Tick(SteadyTime now);

 private:
  struct State;
  explicit Farm(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace strata
