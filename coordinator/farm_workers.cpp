// Workers that come and go, and the passing of time.

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "coordinator/farm_state.h"
#include "coordinator/schedule.h"

namespace strata {
namespace {

/// Why a worker may not join; empty when it may.
std::string RefusalOf(const Hello& hello, const FarmOptions& options) {
  if (hello.protocol != kProtocol) {
    const bool newer = hello.protocol > kProtocol;
    return fmt::format("this worker speaks protocol {} and the coordinator {}; update the {}",
                       hello.protocol, kProtocol, newer ? "coordinator" : "worker");
  }
  if (hello.kernel_revision != options.kernel_revision) {
    return fmt::format(
        "this worker renders with kernel revision {} and the coordinator expects {}; install the "
        "same version on both",
        hello.kernel_revision, options.kernel_revision);
  }
  return "";
}

/// How often a job's figures are computed anew: twice a second, less for large pictures.
SteadyTime::duration SummaryPeriod(const JobSpec& spec) {
  return std::max<SteadyTime::duration>(std::chrono::milliseconds(500),
                                        std::chrono::microseconds(spec.crop.Pixels()));
}

}  // namespace

std::string Farm::Connect(const Hello& hello, std::shared_ptr<WorkerLink> link, SteadyTime now) {
  MutexLock lock(state_->mutex);
  state_->Seen(now);
  const std::string id = fmt::format("w-{}", ++state_->last_worker);
  if (const std::string reason = RefusalOf(hello, state_->options); !reason.empty()) {
    spdlog::warn("worker {} ({}) is refused: {}", id, hello.name, reason);
    link->Send(Refusal{reason, false});
    link->Close();
    return id;
  }
  spdlog::info("worker {} ({}) joins with {} threads", id, hello.name, hello.threads);
  link->Send(Welcome{id, static_cast<uint32_t>(state_->options.heartbeat.count()),
                     static_cast<uint32_t>(state_->options.silence.count())});
  auto worker = std::make_unique<WorkerRecord>();
  worker->id = id;
  worker->hello = hello;
  worker->link = std::move(link);
  worker->connected = worker->heard = now;
  state_->NoteDifferences(*worker);
  state_->workers[id] = std::move(worker);
  state_->Dispatch(now);
  return id;
}

void Farm::State::NoteDifferences(const WorkerRecord& worker) {
  for (const auto& [id, job] : jobs) {
    if (IsFinal(job->state) || !job->spec.reproducible || !job->worker_class) continue;
    const std::string difference = Difference(ClassOf(worker.hello), *job->worker_class);
    if (difference.empty()) continue;
    Log(*job, "warning",
        fmt::format("worker {} ({}) is not used: {}", worker.id, worker.hello.name, difference));
  }
}

void Farm::Disconnect(const std::string& id, SteadyTime now) {
  MutexLock lock(state_->mutex);
  state_->Seen(now);
  const auto entry = state_->workers.find(id);
  if (entry == state_->workers.end()) return;
  spdlog::info("worker {} left", id);
  const std::unique_ptr<WorkerRecord> worker = std::move(entry->second);
  state_->workers.erase(entry);
  state_->LoseLeases(*worker, "the worker vanished while it rendered it", now);
  state_->Dispatch(now);
}

absl::Status Farm::Drain(const std::string& id) {
  MutexLock lock(state_->mutex);
  const auto entry = state_->workers.find(id);
  if (entry == state_->workers.end()) {
    return absl::NotFoundError(fmt::format("worker {} is not connected", id));
  }
  entry->second->draining = true;
  entry->second->link->Send(strata::Drain{});
  return absl::OkStatus();
}

void Farm::State::ExpireSilent(SteadyTime now) {
  for (auto& [id, worker] : workers) {
    if (last_tick) worker->heard = ForgiveStall(worker->heard, *last_tick, now, options.heartbeat);
    if (worker->lost || worker->receiving > 0 || now - worker->heard <= options.silence) continue;
    spdlog::warn("worker {} is silent", id);
    worker->lost = true;
    LoseLeases(*worker, "the worker fell silent while it rendered it", now);
  }
  last_tick = now;
}

void Farm::Tick(SteadyTime now) {
  struct Stale {
    JobId job;
    std::shared_ptr<JobFilm> film;
    double widening;
  };
  std::vector<Stale> to_summarize;
  std::vector<std::shared_ptr<JobFilm>> to_release;
  std::vector<JobId> to_publish, to_drop;
  {
    MutexLock lock(state_->mutex);
    state_->Seen(now);
    state_->ExpireSilent(now);
    to_drop = state_->BeginDrops(now);
    state_->Dispatch(now);
    for (auto& [id, job] : state_->jobs) {
      if (!IsFinal(job->state)) {
        job->rate.Tell(static_cast<double>(job->merged.samples), now);
      }
      if (job->summary_stale && !job->finishing && !IsFinal(job->state) &&
          now - job->summarized >= SummaryPeriod(job->spec)) {
        job->summarized = now;
        job->summary_stale = false;
        job->summary_held = true;
        to_summarize.push_back({id, job->film, job->widening});
      }
      if (IsFinal(job->state) && std::exchange(job->summary_held, false)) {
        to_release.push_back(job->film);
      }
      if (state_->subscriptions.Any(id)) to_publish.push_back(id);
    }
  }
  for (const JobId& job : to_drop) state_->FinishDropped(job, now);
  for (const auto& [id, film, widening] : to_summarize) {
    const FilmSummary summary = RefreshSummary(*film, widening);
    MutexLock lock(state_->mutex);
    const absl::StatusOr<JobRecord*> job = state_->Find(id);
    if (job.ok() && !IsFinal((*job)->state)) (*job)->summary = summary;
  }
  for (const auto& film : to_release) ReleaseSummary(*film);
  for (const JobId& job : to_publish) state_->Publish(job);
}

}  // namespace strata
