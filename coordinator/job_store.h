#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/job.h"
#include "common/report.h"
#include "common/status.h"

namespace strata {

/// A job as it is kept: what a coordinator needs to take it up again, beside its rounds and film.
struct StoredJob {
  JobId id;
  JobSpec spec;
  JobState state = JobState::kQueued;
  std::string message;
  std::string request_id;
  double submitted_unix_s = 0;
};

/// Keeps jobs, the plans of their rounds and their logs. Every call that changes something returns
/// when the change is as durable as this store makes it. Called under the farm's lock, so it need
/// not be thread-safe; errors carry the store's own words.
class JobStore {
 public:
  virtual ~JobStore() = default;

  /// All jobs that were not deleted, in the order of their submission.
  virtual absl::StatusOr<std::vector<StoredJob>> Jobs() const = 0;

  /// The job an earlier AddJob made for this request, which is not empty.
  virtual absl::StatusOr<std::optional<JobId>> FindRequest(std::string_view request_id) const = 0;

  /// Adds a queued job under an id that was never used before. Job and request id become known
  /// together or not at all. An empty request id is not remembered.
  virtual absl::StatusOr<JobId> AddJob(const JobSpec& spec, std::string_view request_id,
                                       double submitted_unix_s) = 0;
  virtual absl::Status SetState(const JobId& job, JobState state, std::string_view message) = 0;
  virtual absl::Status SetPriority(const JobId& job, int priority) = 0;
  /// Forgets the job, its rounds and its log. Its request id stays known no longer either.
  virtual absl::Status DeleteJob(const JobId& job) = 0;

  /// The plan of a round as coordinator/round_plan_format.h writes it. Rounds are saved once each,
  /// in order from 0.
  virtual absl::Status SaveRound(const JobId& job, uint32_t round, std::string_view plan) = 0;
  virtual absl::StatusOr<std::vector<std::string>> Rounds(const JobId& job) const = 0;

  /// The newest kMaxLogLines are kept.
  virtual absl::Status AppendLog(const JobId& job, const LogLine& line) = 0;
  virtual absl::StatusOr<std::vector<LogLine>> Log(const JobId& job) const = 0;

  static constexpr size_t kMaxLogLines = 1000;
};

/// A store in memory. With a path, the number of the last job is kept in that file, so that ids are
/// not used again after a restart and late results of a former life match nothing.
std::unique_ptr<JobStore> NewMemoryJobStore(std::filesystem::path last_job_file = {});

}  // namespace strata
