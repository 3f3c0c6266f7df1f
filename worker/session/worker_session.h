#pragma once

#include <atomic>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "common/messages.h"
#include "common/sync.h"
#include "worker/session/bundle_fetch.h"
#include "worker/session/coordinator_link.h"
#include "worker/session/file_cache.h"
#include "worker/session/render_engine.h"
#include "worker/session/scene_shelf.h"

namespace strata {

/// What a worker does, whatever the link: says hello, loads the scenes of leased jobs, renders
/// their units and sends the results. It outlives connections, so that caches and loaded scenes do.
///
/// Three threads: one loads (files over the link, then the scene), one renders the units of one
/// lease after the other while the next job loads, one sends heartbeats whenever nothing else was
/// sent, whatever the other two are at: with a lease twice as often as asked, so that a delayed one
/// does no harm. No lock is held while anything is sent, loaded or rendered.
class WorkerSession {
 public:
  /// What ends a connection from this side. OK: drained, all results are sent.
  /// FAILED_PRECONDITION: refused for good. UNAVAILABLE: refused for now.
  using OnLeave = std::function<void(const absl::Status&)>;

  /// `on_leave` is called from any thread without locks, at most once for each Attach.
  WorkerSession(Hello hello, std::unique_ptr<FileCache> cache, std::unique_ptr<RenderEngine> engine,
                OnLeave on_leave);
  /// Stops rendering and waits for the threads. Detach before.
  ~WorkerSession();

  /// A connection stands: says hello over it. After Detach or at first.
  void Attach(std::shared_ptr<CoordinatorLink> link);
  /// The connection broke: leases are forgotten, as the coordinator gives them to others. A unit
  /// being rendered is finished and its result sent over the next connection, if its job is still
  /// known there: results are keyed by job and unit.
  void Detach();
  /// A message of the coordinator; never blocks for long.
  void Receive(ToWorker message);
  /// Finish what is held and leave. With no connection, leaves with the next one's welcome.
  void Drain();
  /// Whether a welcome came over the present connection.
  bool Welcomed() const;

 private:
  using Clock = std::chrono::steady_clock;

  /// A job and what has been made of it.
  struct Job {
    JobDescription description;
    bool described = true;                   ///< Over the present connection.
    bool cancelled = false;                  ///< Nobody wants its results any more.
    std::shared_ptr<UnitRenderer> renderer;  ///< Null until loaded.
    absl::Status failure;                    ///< Why it could not be loaded.
    double load_seconds = 0;                 ///< 0: the scene was there.
    uint64_t last_use = 0;                   ///< Counts up: the order of uses.
  };
  /// A lease being rendered.
  struct Current {
    uint64_t lease = 0;
    JobId job;
    std::atomic<bool> cancelled = false;
  };

  void Load();
  void Render();
  void Beat();

  // worker_session.cpp: messages
  void On(Welcome& welcome);
  void On(Refusal& refusal);
  void On(JobDescription& description);
  void On(Lease& lease);
  void On(CancelJob& cancel);  ///< Forgets the job, or many frames would pile up; not its scene.
  void On(CancelLease& cancel);
  void On(FileChunk& chunk);
  void On(strata::Drain&);
  void Say(FromWorker message);
  void SayResult(const Job& job, UnitResult result);
  void LeaveIfDrained();

  // session_work.cpp: loading and rendering
  std::shared_ptr<Job> NextToLoad() STRATA_REQUIRES(mutex_);
  absl::StatusOr<std::shared_ptr<UnitRenderer>> LoadJob(const JobDescription& job,
                                                        double* load_seconds);
  absl::StatusOr<std::shared_ptr<const LoadedScene>> LoadScene(const JobDescription& job);
  absl::StatusOr<CacheSource> Fetch(const JobDescription& job);
  bool IsLeased(const JobId& job) const STRATA_REQUIRES(mutex_);  ///< Not counting current_.
  void DropRenderers(size_t keep) STRATA_REQUIRES(mutex_);
  std::optional<Lease> NextToRender() STRATA_REQUIRES(mutex_);
  void RenderLease(Job& job, const Lease& lease, const Current& current);
  void ReportLoadFailure(Job& job, const Lease& lease, const absl::Status& failure);

  const Hello hello_;
  const std::unique_ptr<FileCache> cache_;
  const std::unique_ptr<RenderEngine> engine_;
  const OnLeave on_leave_;
  SceneShelf shelf_;  ///< The loading thread's alone.

  mutable Mutex mutex_;
  CondVar changed_;
  std::shared_ptr<CoordinatorLink> link_ STRATA_GUARDED_BY(mutex_);
  bool welcomed_ STRATA_GUARDED_BY(mutex_) = false;
  bool draining_ STRATA_GUARDED_BY(mutex_) = false;
  bool left_ STRATA_GUARDED_BY(mutex_) = false;  ///< on_leave_ was called for this connection.
  bool stopping_ STRATA_GUARDED_BY(mutex_) = false;
  std::chrono::milliseconds heartbeat_ STRATA_GUARDED_BY(mutex_){1000};  ///< Of the welcome.
  Clock::time_point last_said_ STRATA_GUARDED_BY(mutex_);
  std::map<JobId, std::shared_ptr<Job>> jobs_ STRATA_GUARDED_BY(mutex_);
  std::deque<Lease> leases_ STRATA_GUARDED_BY(mutex_);  ///< Not begun.
  std::shared_ptr<Current> current_ STRATA_GUARDED_BY(mutex_);
  /// The results of units that outlived their connection, with the spec they were rendered for.
  std::vector<std::pair<JobSpec, UnitResult>> unsent_ STRATA_GUARDED_BY(mutex_);
  std::shared_ptr<BundleFetch> fetch_ STRATA_GUARDED_BY(mutex_);
  JobId fetching_ STRATA_GUARDED_BY(mutex_);  ///< For which job.
  uint64_t uses_ STRATA_GUARDED_BY(mutex_) = 0;

  std::thread loader_, renderer_, heart_;
};

}  // namespace strata
