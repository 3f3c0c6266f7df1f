#pragma once

#include <absl/container/flat_hash_set.h>

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/sync.h"
#include "coordinator/directory_lock.h"
#include "coordinator/farm.h"
#include "coordinator/film_summary.h"
#include "coordinator/lease_table.h"
#include "coordinator/next_round.h"
#include "coordinator/ordered_merge.h"
#include "coordinator/rate_meter.h"
#include "coordinator/subscriptions.h"
#include "coordinator/unit_queue.h"
#include "coordinator/worker_class.h"

// What is behind Farm. Locks, in the order they may be taken: Farm::State::mutex, then
// JobFilm::mutex or the link's own. Merging and estimating hold a JobFilm's alone.

namespace strata {

/// A job's film and what merges into it.
struct JobFilm {
  explicit JobFilm(SamplerKind drawn_by) : sampler(drawn_by) {}

  const SamplerKind sampler;
  mutable Mutex mutex;
  std::unique_ptr<Film> film STRATA_GUARDED_BY(mutex);
  /// Of the round; nothing once a round was dropped, so that no late result gets in.
  std::unique_ptr<OrderedMerge> merge STRATA_GUARDED_BY(mutex);
  std::vector<bool> changed STRATA_GUARDED_BY(mutex);  ///< Tiles since the last summary.

  /// Serialises summaries of the job; taken before `mutex`.
  Mutex summary_mutex;
  std::unique_ptr<SummaryInput> summary STRATA_GUARDED_BY(summary_mutex);
};

/// Estimates the tiles that changed, and those they touch, and sums the picture up, with intervals
/// `widening` times those of Estimate. Locks the film for one tile at a time.
FilmSummary RefreshSummary(JobFilm& film, double widening);

/// Where the film of a job lies, and its copy from before the round, when that may be dropped.
std::filesystem::path FilmPath(const FarmOptions& options, const JobId& job);
std::filesystem::path KeptFilmPath(const FarmOptions& options, const JobId& job);

/// Gives back the memory that RefreshSummary works in; the next call estimates all tiles.
void ReleaseSummary(JobFilm& film);

/// A round that can be started at once: what takes time for a large picture is made without the
/// farm's lock.
struct PreparedRound {
  explicit PreparedRound(RoundPlan made);

  std::shared_ptr<const RoundPlan> plan;
  std::string bytes;  ///< The plan as it is saved.
  uint64_t samples, units;
  std::unique_ptr<UnitQueue> queue;  ///< Offers nothing before its window is widened.
};

/// A unit that failed on workers, or whose workers vanished with it. It is leased singly, so that
/// it alone is to blame when that happens again.
struct UnitTrouble {
  std::vector<std::string> workers;  ///< One entry for each time it failed or was being rendered.
  std::string reason, replay;        ///< Of the last failure.
};

struct JobRecord {
  JobId id;
  uint64_t number = 0;  ///< In the order of submission.
  JobSpec spec;
  JobState state = JobState::kQueued;
  std::string message;

  std::shared_ptr<const RoundPlan> plan;
  std::shared_ptr<JobFilm> film;
  std::unique_ptr<UnitQueue> queue;
  uint64_t planned_samples = 0, planned_units = 0;  ///< Of all rounds so far.
  MergedCounts merged;
  MergedCounts merged_before;  ///< The round: what is left when it is dropped.
  /// The round is merged or dropped; the next one or the final figures are being made.
  bool finishing = false;
  uint32_t rounds = 0;        ///< Wholly merged.
  RemainingSamples expected;  ///< All samples of the job, as the last plan estimated them.
  bool target_met = false;
  double target_share = 0;
  double widening = 1;  ///< Of intervals, as long as somebody may still wait for a better one.

  std::optional<WorkerClass> worker_class;  ///< Of the first worker; binding if reproducible.
  std::map<UnitId, UnitTrouble> troubles;
  std::map<std::string, std::string> job_failures;  ///< Worker to reason: it cannot render the job.

  uint64_t received_samples = 0;
  double received_cost = 0;  ///< Of received units; see Farm::State::Served.
  double served_offset = 0;
  FilmSummary summary;
  SteadyTime summarized;
  bool summary_stale = false;
  bool summary_held = true;  ///< What figures of a job in progress are made of is in memory.
  SteadyTime published;

  double submitted_unix_s = 0;
  SteadyTime submitted;
  std::optional<SteadyTime> first_lease, render_began, last_merge, ended;
  double load_s = 0;
  int64_t background_pixels = 0;  ///< See JobStatus.
  RateMeter rate;
  uint64_t replays_logged = 0;
  Digest result;
};

/// How fast a worker renders a job.
struct WorkerRate {
  bool warm = false;  ///< Its first result has come: the scene is loaded.
  double samples = 0, seconds = 0;
};

struct WorkerRecord {
  std::string id;
  Hello hello;
  std::shared_ptr<WorkerLink> link;
  SteadyTime connected, heard;
  bool draining = false;
  bool lost = false;    ///< Silent for too long; its leases are gone.
  int receiving = 0;    ///< Calls of Receive under way: it is not silent, we are busy.
  SteadyTime rendered;  ///< When its last result came.
  uint64_t samples = 0;
  uint32_t refused_partials = 0;
  absl::flat_hash_set<JobId> described;
  std::map<JobId, WorkerRate> rates;
};

struct Farm::State {
  State(FarmOptions farm_options, std::unique_ptr<DirectoryLock> state_dir_lock,
        std::unique_ptr<JobStore> job_store, FileStore file_store)
      : options(std::move(farm_options)),
        directory_lock(std::move(state_dir_lock)),
        files(std::move(file_store)),
        store(std::move(job_store)) {}

  const FarmOptions options;
  const std::unique_ptr<DirectoryLock> directory_lock;
  const FileStore files;
  Subscriptions subscriptions;

  mutable Mutex mutex;
  std::unique_ptr<JobStore> store STRATA_GUARDED_BY(mutex);
  std::map<JobId, std::unique_ptr<JobRecord>> jobs STRATA_GUARDED_BY(mutex);
  std::map<std::string, std::unique_ptr<WorkerRecord>> workers STRATA_GUARDED_BY(mutex);
  LeaseTable leases STRATA_GUARDED_BY(mutex);
  /// A worker that might hold more got nothing when it was last looked at.
  bool some_wait STRATA_GUARDED_BY(mutex) = false;
  uint64_t last_worker STRATA_GUARDED_BY(mutex) = 0;
  uint64_t last_job_number STRATA_GUARDED_BY(mutex) = 0;
  SteadyTime latest STRATA_GUARDED_BY(mutex);  ///< The latest `now` seen.
  std::optional<SteadyTime> last_tick STRATA_GUARDED_BY(mutex);

  // ---- farm_jobs.cpp ----
  absl::StatusOr<JobRecord*> Find(const JobId& job) STRATA_REQUIRES(mutex);
  absl::StatusOr<JobId> AddJob(const JobSpec& spec, const std::string& request_id, SteadyTime now)
      STRATA_REQUIRES(mutex);
  /// Makes the job's film and starts its first round.
  absl::Status Prepare(JobRecord& job) STRATA_REQUIRES(mutex);
  /// Lets workers have the job's units again.
  void Requeue(JobRecord& job, SteadyTime now) STRATA_REQUIRES(mutex);
  /// Changes the state, in the store and the log too.
  void SetState(JobRecord& job, JobState state, const std::string& message, SteadyTime now)
      STRATA_REQUIRES(mutex);
  /// As SetState with a final state; leases end and workers are told.
  void EndJob(JobRecord& job, JobState state, const std::string& message, SteadyTime now)
      STRATA_REQUIRES(mutex);
  /// To the job's log and to this program's; levels are those of LogLine.
  void Log(const JobRecord& job, std::string_view level, const std::string& text)
      STRATA_REQUIRES(mutex);
  void Seen(SteadyTime now) STRATA_REQUIRES(mutex);

  // ---- farm_status.cpp ----
  JobStatus StatusOf(const JobRecord& job) const STRATA_REQUIRES(mutex);
  double FractionOf(const JobRecord& job) const STRATA_REQUIRES(mutex);
  void AddTimeLeft(const JobRecord& job, JobStatus& status) const STRATA_REQUIRES(mutex);
  /// Why no worker renders the job; empty when one may.
  std::string WaitReason(const JobRecord& job) const STRATA_REQUIRES(mutex);
  /// Calls the job's subscribers, unless it goes on and they were called just now; a tick will.
  void Publish(const JobId& job) STRATA_EXCLUDES(mutex);

  // ---- farm_dispatch.cpp ----
  /// Leases units to all workers that may hold more, those with nothing first.
  void Dispatch(SteadyTime now) STRATA_REQUIRES(mutex);
  /// The same where only these workers may have come to hold fewer: with thousands connected, what
  /// a result costs must not grow with them.
  void DispatchTo(const std::vector<std::string>& ids, SteadyTime now) STRATA_REQUIRES(mutex);
  void GrantTo(const std::vector<WorkerRecord*>& those, SteadyTime now) STRATA_REQUIRES(mutex);
  bool GrantNext(WorkerRecord& worker, SteadyTime now) STRATA_REQUIRES(mutex);
  bool GrantFrom(JobRecord& job, WorkerRecord& worker, SteadyTime now) STRATA_REQUIRES(mutex);
  bool GrantDuplicate(WorkerRecord& worker, SteadyTime now) STRATA_REQUIRES(mutex);
  void Grant(JobRecord& job, WorkerRecord& worker, std::vector<UnitId> units, SteadyTime now)
      STRATA_REQUIRES(mutex);
  /// May this worker render units of this job now?
  bool MayRender(const JobRecord& job, const WorkerRecord& worker) const STRATA_REQUIRES(mutex);
  bool MayRenderUnit(const JobRecord& job, const WorkerRecord& worker, const UnitId& unit) const
      STRATA_REQUIRES(mutex);
  std::vector<const WorkerRecord*> WorkersFor(const JobRecord& job) const STRATA_REQUIRES(mutex);
  /// Work received and leased, in rays and samples, offset so that a job that comes or comes back
  /// stands level with the least served of its equals.
  double Served(const JobRecord& job) const STRATA_REQUIRES(mutex);
  void LevelService(JobRecord& job) STRATA_REQUIRES(mutex);

  // ---- farm_receive.cpp ----
  void ReceiveResult(const std::string& worker, UnitResult result, SteadyTime now)
      STRATA_EXCLUDES(mutex);
  void ReceiveFailure(const std::string& worker, UnitFailure failure, SteadyTime now)
      STRATA_EXCLUDES(mutex);
  void ReceiveRequest(const std::string& worker, const FileRequest& request) STRATA_EXCLUDES(mutex);
  void RefusePartial(const std::string& worker, const JobId& job, const UnitId& unit,
                     const std::string& reason, SteadyTime now) STRATA_EXCLUDES(mutex);
  /// Merges what was checked against `plan`, and does the bookkeeping; true when the round is
  /// complete.
  bool MergeResult(const std::string& worker, UnitResult result,
                   const std::shared_ptr<const RoundPlan>& plan, JobFilm& film, uint32_t window,
                   SteadyTime now) STRATA_EXCLUDES(mutex);
  void MeasureWorker(JobRecord& job, WorkerRecord& worker, const UnitResult& result,
                     uint64_t samples, SteadyTime now) STRATA_REQUIRES(mutex);
  void LogNonFinite(JobRecord& job, const std::vector<std::string>& replays) STRATA_REQUIRES(mutex);

  // ---- farm_rounds.cpp ----
  /// Saves the round's plan, then makes its units leasable.
  absl::Status StartRound(JobRecord& job, PreparedRound round) STRATA_REQUIRES(mutex);
  /// True when the round is complete and nobody was told so yet: FinishRound is to be called.
  bool BeginFinish(JobRecord& job) STRATA_REQUIRES(mutex);
  /// Starts the next round or, when there is none, makes the final figures and ends the job.
  void FinishRound(const JobId& job, SteadyTime now) STRATA_EXCLUDES(mutex);
  /// Jobs whose deadline has come in the middle of a round that can be dropped; FinishDropped is to
  /// be called for each.
  std::vector<JobId> BeginDrops(SteadyTime now) STRATA_REQUIRES(mutex);
  /// Drops the round whole and ends the job with the rounds before it.
  void FinishDropped(const JobId& job, SteadyTime now) STRATA_EXCLUDES(mutex);
  /// Makes the final figures and ends the job well.
  void Complete(const JobId& job, const std::string& message, SteadyTime now)
      STRATA_EXCLUDES(mutex);
  std::optional<SteadyTime> Deadline(const JobRecord& job) const STRATA_REQUIRES(mutex);

  // ---- farm_failures.cpp ----
  /// A unit failed on a worker or vanished with it; fails the job when that was once too often.
  void CountFailure(JobRecord& job, const std::string& worker, const UnitId& unit,
                    const std::string& reason, const std::string& replay, SteadyTime now)
      STRATA_REQUIRES(mutex);
  void CountJobFailure(JobRecord& job, const std::string& worker, const std::string& reason,
                       const std::string& replay, SteadyTime now) STRATA_REQUIRES(mutex);
  /// Takes the worker's leases away and gives the units back.
  void LoseLeases(WorkerRecord& worker, const std::string& reason, SteadyTime now)
      STRATA_REQUIRES(mutex);

  // ---- farm_workers.cpp ----
  void ExpireSilent(SteadyTime now) STRATA_REQUIRES(mutex);
  /// Tells the logs of jobs for which this worker cannot be used.
  void NoteDifferences(const WorkerRecord& worker) STRATA_REQUIRES(mutex);
};

}  // namespace strata
