// Units and jobs that workers cannot render, and workers that vanish.

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "coordinator/farm_state.h"

namespace strata {
namespace {

std::string WithReplay(const std::string& reason, const std::string& replay) {
  return replay.empty() ? reason : fmt::format("{}; see it with: {}", reason, replay);
}

std::string UnitText(const UnitId& unit) {
  return fmt::format("unit {}/{}/{}", unit.round, unit.tile, unit.piece);
}

}  // namespace

void Farm::State::ReceiveFailure(const std::string& worker, UnitFailure failure, SteadyTime now) {
  {
    MutexLock lock(mutex);
    const auto entry = jobs.find(failure.job);
    if (entry == jobs.end() || IsFinal(entry->second->state)) return;
    JobRecord& job = *entry->second;
    if (failure.job_wide) {
      CountJobFailure(job, worker, failure.reason, failure.replay, now);
    } else if (leases.GiveUp(worker, job.id, failure.unit)) {
      // Only of a unit that this worker holds: anything else is late news.
      CountFailure(job, worker, failure.unit, failure.reason, failure.replay, now);
    }
    Dispatch(now);
  }
  Publish(failure.job);
}

void Farm::State::RefusePartial(const std::string& worker, const JobId& id, const UnitId& unit,
                                const std::string& reason, SteadyTime now) {
  MutexLock lock(mutex);
  const auto job = jobs.find(id);
  const auto from = workers.find(worker);
  if (job == jobs.end() || from == workers.end()) return;
  const std::string text = fmt::format("the result was refused: {}", reason);
  Log(*job->second, "warning", fmt::format("{} of worker {}: {}", UnitText(unit), worker, text));
  if (!IsFinal(job->second->state) && leases.GiveUp(worker, id, unit)) {
    CountFailure(*job->second, worker, unit, text, "", now);
  }
  if (++from->second->refused_partials >= options.max_unit_failures) {
    spdlog::warn("worker {} is sent away: {} of its results were refused", worker,
                 from->second->refused_partials);
    from->second->draining = true;
    from->second->link->Send(
        Refusal{fmt::format("{} results of this worker were refused, the last one as {}",
                            from->second->refused_partials, reason),
                false});
    from->second->link->Close();
  }
  Dispatch(now);
}

void Farm::State::CountFailure(JobRecord& job, const std::string& worker, const UnitId& unit,
                               const std::string& reason, const std::string& replay,
                               SteadyTime now) {
  if (leases.Holders(job.id, unit) == 0) job.queue->Return(unit);
  UnitTrouble& trouble = job.troubles[unit];
  trouble.workers.push_back(worker);
  trouble.reason = reason;
  if (!replay.empty()) trouble.replay = replay;
  Log(job, "warning",
      fmt::format("{} on worker {}: {}", UnitText(unit), worker,
                  WithReplay(reason, trouble.replay)));
  if (trouble.workers.size() >= options.max_unit_failures) {
    EndJob(job, JobState::kFailed,
           fmt::format("{} failed {} times: {}", UnitText(unit), trouble.workers.size(),
                       WithReplay(reason, trouble.replay)),
           now);
  }
}

void Farm::State::CountJobFailure(JobRecord& job, const std::string& worker,
                                  const std::string& reason, const std::string& replay,
                                  SteadyTime now) {
  const std::string text = WithReplay(reason, replay);
  Log(job, "warning", fmt::format("worker {} cannot render it: {}", worker, text));
  job.job_failures[worker] = text;
  // A second opinion is asked for where there is one to be had.
  if (job.job_failures.size() >= 2 || WorkersFor(job).empty()) {
    EndJob(job, JobState::kFailed, text, now);
    return;
  }
  std::vector<UnitId> held;
  for (const auto& [id, lease] : leases.leases()) {
    if (lease.job != job.id || lease.worker != worker) continue;
    held.insert(held.end(), lease.units.begin(), lease.units.end());
  }
  for (const UnitId& unit : held) {
    leases.GiveUp(worker, job.id, unit);
    if (leases.Holders(job.id, unit) == 0) job.queue->Return(unit);
  }
}

void Farm::State::LoseLeases(WorkerRecord& worker, const std::string& reason, SteadyTime now) {
  const std::vector<LeaseRecord> lost = leases.RemoveWorker(worker.id);
  bool rendering = !worker.draining;  // The first unit of the oldest lease.
  for (const LeaseRecord& lease : lost) {
    worker.link->Send(CancelLease{lease.id});
    JobRecord& job = *jobs.at(lease.job);
    for (const UnitId& unit : lease.units) {
      const bool was_rendered = std::exchange(rendering, false);
      if (leases.Holders(job.id, unit) > 0) continue;  // A duplicate goes on.
      job.queue->Return(unit);
      if (!worker.draining) job.troubles.try_emplace(unit);
      if (was_rendered) CountFailure(job, worker.id, unit, reason, "", now);
    }
  }
}

}  // namespace strata
