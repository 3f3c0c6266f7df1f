#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "common/replay_command.h"
#include "worker/session/worker_session.h"

// The threads of a session that load and render.

namespace strata {
namespace {

/// Whether another worker would fail the same way: the fault is the scene's or the job's.
bool IsJobsFault(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kInvalidArgument:
    case absl::StatusCode::kNotFound:
    case absl::StatusCode::kFailedPrecondition:
    case absl::StatusCode::kOutOfRange:
    case absl::StatusCode::kUnimplemented:
    case absl::StatusCode::kDataLoss:
      return true;
    default:
      return false;
  }
}

/// Shows a unit's failure by its first sample.
std::string ReplayOf(const JobSpec& spec, const WorkUnit& unit) {
  return ReplayCommand(spec, unit.pixels.x0, unit.pixels.y0, 0, unit.RangeOf(0).begin);
}

}  // namespace

void WorkerSession::Load() {
  while (true) {
    std::shared_ptr<Job> job;
    {
      MutexLock lock(mutex_);
      while (!stopping_ && !(job = NextToLoad())) changed_.Wait(mutex_);
      if (stopping_) return;
    }
    double load_seconds = 0;
    absl::StatusOr<std::shared_ptr<UnitRenderer>> renderer =
        LoadJob(job->description, &load_seconds);
    {
      MutexLock lock(mutex_);
      job->load_seconds = load_seconds;
      job->last_use = ++uses_;
      if (renderer.ok()) {
        job->renderer = *std::move(renderer);
        DropRenderers(SceneShelf::kScenes);
      } else if (!absl::IsCancelled(renderer.status()) && IsLeased(job->description.job)) {
        job->failure = renderer.status();
      }
    }
    changed_.NotifyAll();
  }
}

std::shared_ptr<WorkerSession::Job> WorkerSession::NextToLoad() {
  for (const Lease& lease : leases_) {
    const std::shared_ptr<Job>& job = jobs_.at(lease.job);
    if (!job->renderer && job->failure.ok()) return job;
  }
  return nullptr;
}

absl::StatusOr<std::shared_ptr<UnitRenderer>> WorkerSession::LoadJob(const JobDescription& job,
                                                                     double* load_seconds) {
  const Digest bundle = BundleDigest(job.spec.bundle);
  std::shared_ptr<const LoadedScene> scene = shelf_.Find(bundle);
  if (!scene) {
    const Clock::time_point begin = Clock::now();
    STRATA_ASSIGN_OR_RETURN(scene, LoadScene(job));
    *load_seconds = std::chrono::duration<double>(Clock::now() - begin).count();
    spdlog::info("{}: scene {} loaded in {:.2f} s", job.job, job.spec.bundle.scene, *load_seconds);
    if (!shelf_.MakeRoom()) {
      // What other jobs hold goes next; leased ones keep theirs.
      MutexLock lock(mutex_);
      DropRenderers(0);
    }
    if (!shelf_.MakeRoom()) {
      return absl::ResourceExhaustedError(
          absl::StrCat("the scene takes this worker over its --memory-limit of ",
                       hello_.memory_limit, " bytes"));
    }
    shelf_.Put(bundle, scene);
  }
  STRATA_ASSIGN_OR_RETURN(std::unique_ptr<UnitRenderer> renderer,
                          engine_->Prepare(std::move(scene), job.spec));
  return std::shared_ptr<UnitRenderer>(std::move(renderer));
}

absl::StatusOr<std::shared_ptr<const LoadedScene>> WorkerSession::LoadScene(
    const JobDescription& job) {
  const FileCache::Hold hold(*cache_, job.spec.bundle.files);
  STRATA_ASSIGN_OR_RETURN(const CacheSource source, Fetch(job));
  return engine_->Load(source, job.spec.bundle);
}

absl::StatusOr<CacheSource> WorkerSession::Fetch(const JobDescription& job) {
  auto fetch = std::make_shared<BundleFetch>(*cache_, job.spec.bundle,
                                             [this](const FileRequest& request) { Say(request); });
  {
    MutexLock lock(mutex_);
    if (!welcomed_) return absl::CancelledError("the connection to the coordinator broke");
    fetch_ = fetch;
    fetching_ = job.job;
  }
  absl::StatusOr<CacheSource> source = fetch->Run();
  MutexLock lock(mutex_);
  fetch_.reset();
  fetching_.clear();
  return source;
}

bool WorkerSession::IsLeased(const JobId& job) const {
  return std::any_of(leases_.begin(), leases_.end(),
                     [&](const Lease& lease) { return lease.job == job; });
}

void WorkerSession::DropRenderers(size_t keep) {
  std::vector<Job*> idle;
  size_t busy = 0;
  for (const auto& [id, job] : jobs_) {
    if (!job->renderer) continue;
    if (IsLeased(id) || (current_ && current_->job == id)) {
      ++busy;
    } else {
      idle.push_back(job.get());
    }
  }
  std::sort(idle.begin(), idle.end(),
            [](const Job* a, const Job* b) { return a->last_use > b->last_use; });
  for (size_t i = keep > busy ? keep - busy : 0; i < idle.size(); ++i) idle[i]->renderer.reset();
}

void WorkerSession::Render() {
  while (true) {
    std::optional<Lease> lease;
    std::shared_ptr<Job> job;
    std::shared_ptr<Current> current;
    absl::Status failure;
    {
      MutexLock lock(mutex_);
      while (!stopping_ && !(lease = NextToRender())) changed_.Wait(mutex_);
      if (stopping_) return;
      job = jobs_.at(lease->job);
      job->last_use = ++uses_;
      current = std::make_shared<Current>();
      current->lease = lease->lease;
      current->job = lease->job;
      current_ = current;
      failure = job->failure;
    }
    if (failure.ok()) {
      RenderLease(*job, *lease, *current);
    } else {
      ReportLoadFailure(*job, *lease, failure);
    }
    {
      MutexLock lock(mutex_);
      current_.reset();
    }
    LeaveIfDrained();
  }
}

std::optional<Lease> WorkerSession::NextToRender() {
  // A lease whose scene is being loaded lets later ones pass.
  const auto can_render = [&](const Lease& lease) STRATA_REQUIRES(mutex_) {
    const Job& job = *jobs_.at(lease.job);
    return job.renderer || !job.failure.ok();
  };
  const auto ready = std::find_if(leases_.begin(), leases_.end(), can_render);
  if (ready == leases_.end()) return std::nullopt;
  Lease lease = std::move(*ready);
  leases_.erase(ready);
  return lease;
}

void WorkerSession::RenderLease(Job& job, const Lease& lease, const Current& current) {
  std::shared_ptr<UnitRenderer> renderer;
  double load_seconds = 0;
  {
    MutexLock lock(mutex_);
    renderer = job.renderer;
    load_seconds = job.load_seconds;
  }
  for (const WorkUnit& unit : lease.units) {
    if (current.cancelled) return;
    absl::StatusOr<Partial> partial = renderer->Render(unit, current.cancelled);
    if (partial.ok()) {
      SayResult(job, {lease.job, lease.lease, *std::move(partial), load_seconds,
                      renderer->BackgroundPixels()});
    } else if (!current.cancelled) {
      Say(UnitFailure{lease.job, lease.lease, unit.id, std::string(partial.status().message()),
                      ReplayOf(job.description.spec, unit), false});
    }
    MutexLock lock(mutex_);
    if (!welcomed_) return;  // The rest of the lease is others' by now.
  }
}

void WorkerSession::ReportLoadFailure(Job& job, const Lease& lease, const absl::Status& failure) {
  const std::string reason(failure.message());
  spdlog::error("{}: {}", lease.job, reason);
  const bool job_wide = IsJobsFault(failure);
  for (const WorkUnit& unit : lease.units) {
    Say(UnitFailure{lease.job, lease.lease, unit.id, reason, CheckCommand(job.description.spec),
                    job_wide});
    if (job_wide) break;
  }
  MutexLock lock(mutex_);
  // The next lease tries again, once the others that waited have been told.
  if (!IsLeased(lease.job)) job.failure = absl::OkStatus();
}

}  // namespace strata
