#include "worker/session/worker_session.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

namespace strata {
namespace {

/// Results kept for the next connection; more are only lost time.
constexpr size_t kMaxUnsent = 4;

}  // namespace

WorkerSession::WorkerSession(Hello hello, std::unique_ptr<FileCache> cache,
                             std::unique_ptr<RenderEngine> engine, OnLeave on_leave)
    : hello_(std::move(hello)),
      cache_(std::move(cache)),
      engine_(std::move(engine)),
      on_leave_(std::move(on_leave)),
      shelf_(hello_.memory_limit),
      loader_([this] { Load(); }),
      renderer_([this] { Render(); }),
      heart_([this] { Beat(); }) {}

WorkerSession::~WorkerSession() {
  Detach();
  {
    MutexLock lock(mutex_);
    stopping_ = true;
    if (current_) current_->cancelled = true;
  }
  changed_.NotifyAll();
  loader_.join();
  renderer_.join();
  heart_.join();
}

void WorkerSession::Attach(std::shared_ptr<CoordinatorLink> link) {
  {
    MutexLock lock(mutex_);
    link_ = std::move(link);
    left_ = false;
  }
  Say(hello_);
}

void WorkerSession::Detach() {
  std::shared_ptr<BundleFetch> fetch;
  {
    MutexLock lock(mutex_);
    link_.reset();
    welcomed_ = false;
    leases_.clear();
    std::erase_if(jobs_, [](const auto& job) { return !job.second->described; });
    for (const auto& [id, job] : jobs_) job->described = false;
    fetch = fetch_;
  }
  if (fetch) fetch->Abort(absl::CancelledError("the connection to the coordinator broke"));
  changed_.NotifyAll();
}

void WorkerSession::Receive(ToWorker message) {
  std::visit([this](auto& alternative) { On(alternative); }, message);
  changed_.NotifyAll();
}

void WorkerSession::Drain() {
  bool connected = false;
  {
    MutexLock lock(mutex_);
    if (draining_) return;
    draining_ = true;
    connected = welcomed_;
  }
  if (connected) Say(Draining{});
  LeaveIfDrained();
}

bool WorkerSession::Welcomed() const {
  MutexLock lock(mutex_);
  return welcomed_;
}

void WorkerSession::On(Welcome& welcome) {
  spdlog::info("joined as {}", welcome.worker);
  bool draining = false;
  {
    MutexLock lock(mutex_);
    welcomed_ = true;
    heartbeat_ = std::chrono::milliseconds(std::max(welcome.heartbeat_ms, 2u));
    draining = draining_;
  }
  if (draining) Say(Draining{});
  LeaveIfDrained();
}

void WorkerSession::On(Refusal& refusal) {
  {
    MutexLock lock(mutex_);
    if (left_) return;
    left_ = true;
  }
  const std::string reason = absl::StrCat("refused by the coordinator: ", refusal.reason);
  on_leave_(refusal.retry ? absl::UnavailableError(reason) : absl::FailedPreconditionError(reason));
}

void WorkerSession::On(JobDescription& description) {
  std::vector<UnitResult> late;
  {
    MutexLock lock(mutex_);
    std::shared_ptr<Job>& job = jobs_[description.job];
    if (job && job->description.spec == description.spec) {
      job->described = true;
    } else {
      job = std::make_shared<Job>();
      job->description = description;
    }
    // Only results for this very spec: another coordinator may use the same id for something else.
    std::vector<std::pair<JobSpec, UnitResult>> rest;
    for (auto& [spec, result] : unsent_) {
      if (result.job != description.job) {
        rest.emplace_back(std::move(spec), std::move(result));
      } else if (spec == description.spec) {
        late.push_back(std::move(result));
      }
    }
    unsent_ = std::move(rest);
  }
  for (UnitResult& result : late) Say(std::move(result));
}

void WorkerSession::On(Lease& lease) {
  MutexLock lock(mutex_);
  const auto job = jobs_.find(lease.job);
  if (job == jobs_.end() || !job->second->described) {
    spdlog::error("lease {} is of job {}, which was not described", lease.lease, lease.job);
    return;
  }
  leases_.push_back(std::move(lease));
}

void WorkerSession::On(CancelJob& cancel) {
  std::shared_ptr<BundleFetch> fetch;
  std::shared_ptr<Job> job;  // Lives until the lock is gone.
  {
    MutexLock lock(mutex_);
    std::erase_if(leases_, [&](const Lease& lease) { return lease.job == cancel.job; });
    if (current_ && current_->job == cancel.job) current_->cancelled = true;
    if (const auto known = jobs_.find(cancel.job); known != jobs_.end()) {
      job = std::move(known->second);
      job->cancelled = true;
      jobs_.erase(known);
    }
    if (fetching_ == cancel.job) fetch = fetch_;
  }
  if (fetch) fetch->Abort(absl::CancelledError("the job was cancelled"));
  LeaveIfDrained();
}

void WorkerSession::On(CancelLease& cancel) {
  {
    MutexLock lock(mutex_);
    std::erase_if(leases_, [&](const Lease& lease) { return lease.lease == cancel.lease; });
    if (current_ && current_->lease == cancel.lease) current_->cancelled = true;
  }
  LeaveIfDrained();
}

void WorkerSession::On(FileChunk& chunk) {
  std::shared_ptr<BundleFetch> fetch;
  {
    MutexLock lock(mutex_);
    fetch = fetch_;
  }
  if (fetch) fetch->Offer(std::move(chunk));
}

void WorkerSession::On(strata::Drain&) { Drain(); }

void WorkerSession::Say(FromWorker message) {
  std::shared_ptr<CoordinatorLink> link;
  {
    MutexLock lock(mutex_);
    link = link_;
    last_said_ = Clock::now();
  }
  if (link) link->Send(std::move(message));
}

void WorkerSession::SayResult(const Job& job, UnitResult result) {
  {
    MutexLock lock(mutex_);
    if (job.cancelled) return;
    if (!job.described || !welcomed_) {
      if (unsent_.size() < kMaxUnsent) {
        unsent_.emplace_back(job.description.spec, std::move(result));
      }
      return;
    }
  }
  Say(std::move(result));
}

void WorkerSession::LeaveIfDrained() {
  {
    MutexLock lock(mutex_);
    if (!draining_ || !welcomed_ || left_ || current_ || !leases_.empty()) return;
    left_ = true;
  }
  on_leave_(absl::OkStatus());
}

void WorkerSession::Beat() {
  while (true) {
    {
      MutexLock lock(mutex_);
      while (!stopping_) {
        const bool idle = leases_.empty() && !current_;
        const Clock::time_point due = last_said_ + (idle ? heartbeat_ : heartbeat_ / 2);
        if (!welcomed_) {
          changed_.Wait(mutex_);
        } else if (Clock::now() < due) {
          changed_.WaitUntil(mutex_, due);
        } else {
          break;
        }
      }
      if (stopping_) return;
    }
    Say(Heartbeat{});
  }
}

}  // namespace strata
