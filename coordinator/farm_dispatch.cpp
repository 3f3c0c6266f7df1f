// Which worker gets which units.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coordinator/farm_state.h"
#include "coordinator/schedule.h"

namespace strata {

bool Farm::State::MayRender(const JobRecord& job, const WorkerRecord& worker) const {
  if (worker.draining || worker.lost || job.job_failures.contains(worker.id)) return false;
  return !job.spec.reproducible || !job.worker_class || *job.worker_class == ClassOf(worker.hello);
}

std::vector<const WorkerRecord*> Farm::State::WorkersFor(const JobRecord& job) const {
  std::vector<const WorkerRecord*> able;
  for (const auto& [id, worker] : workers) {
    if (MayRender(job, *worker)) able.push_back(worker.get());
  }
  return able;
}

bool Farm::State::MayRenderUnit(const JobRecord& job, const WorkerRecord& worker,
                                const UnitId& unit) const {
  const auto trouble = job.troubles.find(unit);
  if (trouble == job.troubles.end()) return true;
  const std::vector<std::string>& tried = trouble->second.workers;
  const auto has_tried = [&](const std::string& id) {
    return std::find(tried.begin(), tried.end(), id) != tried.end();
  };
  if (!has_tried(worker.id)) return true;
  // The same worker tries again only when there is no other one to ask.
  const std::vector<const WorkerRecord*> able = WorkersFor(job);
  return std::all_of(able.begin(), able.end(),
                     [&](const WorkerRecord* other) { return has_tried(other->id); });
}

double Farm::State::Served(const JobRecord& job) const {
  const double out = static_cast<double>(leases.UnitsOut(job.id));
  const double units = static_cast<double>(job.planned_units);
  const double samples_per_unit = static_cast<double>(job.planned_samples) / units;
  // Before the first result a sample is taken to cost as much as a few rays.
  constexpr double kCostUnknown = 5;
  const double cost = job.received_samples > 0
                          ? job.received_cost / static_cast<double>(job.received_samples)
                          : kCostUnknown;
  return job.served_offset + job.received_cost + out * samples_per_unit * cost;
}

void Farm::State::LevelService(JobRecord& job) {
  job.served_offset = 0;
  const double own = Served(job);
  std::optional<double> least;
  for (const auto& [id, other] : jobs) {
    if (other.get() == &job || IsFinal(other->state) || other->state == JobState::kPaused ||
        other->spec.priority != job.spec.priority) {
      continue;
    }
    least = std::min(least.value_or(Served(*other)), Served(*other));
  }
  if (least) job.served_offset = *least - own;
}

void Farm::State::Dispatch(SteadyTime now) {
  for (auto& [id, job] : jobs) {
    job->queue->WidenWindow(WindowFor(job->plan->grid.Count(), static_cast<int>(workers.size())));
  }
  std::vector<WorkerRecord*> all;
  for (auto& [id, worker] : workers) all.push_back(worker.get());
  GrantTo(all, now);
}

void Farm::State::DispatchTo(const std::vector<std::string>& ids, SteadyTime now) {
  if (some_wait) return Dispatch(now);
  std::vector<WorkerRecord*> those;
  for (const std::string& id : ids) {
    const auto entry = workers.find(id);
    if (entry != workers.end()) those.push_back(entry->second.get());
  }
  GrantTo(those, now);
}

void Farm::State::GrantTo(const std::vector<WorkerRecord*>& those, SteadyTime now) {
  some_wait = false;
  if (std::all_of(jobs.begin(), jobs.end(),
                  [](const auto& entry) { return IsFinal(entry.second->state); }))
    return;
  for (int wanted = 1; wanted <= kLeasesPerWorker; ++wanted) {
    for (WorkerRecord* worker : those) {
      while (leases.Count(worker->id) < wanted) {
        if (GrantNext(*worker, now)) continue;
        // Units that become ready later are for those who may render them.
        some_wait = some_wait || std::any_of(jobs.begin(), jobs.end(),
                                             [&](const auto& entry) STRATA_REQUIRES(mutex) {
                                               return MayRender(*entry.second, *worker);
                                             });
        break;
      }
    }
  }
}

bool Farm::State::GrantNext(WorkerRecord& worker, SteadyTime now) {
  if (worker.draining || worker.lost) return false;
  std::vector<JobOffer> offers;
  std::vector<JobRecord*> offering;
  for (auto& [id, job] : jobs) {
    if (job->state != JobState::kQueued && job->state != JobState::kRunning) continue;
    if (!job->queue->HasReady() || !MayRender(*job, worker)) continue;
    offers.push_back({offers.size(), job->spec.priority, Served(*job), job->number});
    offering.push_back(job.get());
  }
  while (const std::optional<size_t> picked = PickJob(offers)) {
    if (GrantFrom(*offering[*picked], worker, now)) return true;
    std::erase_if(offers, [&](const JobOffer& offer) { return offer.index == *picked; });
  }
  return leases.Count(worker.id) == 0 && GrantDuplicate(worker, now);
}

bool Farm::State::GrantFrom(JobRecord& job, WorkerRecord& worker, SteadyTime now) {
  const auto may_render = [&](const UnitId& unit)
                              STRATA_REQUIRES(mutex) { return MayRenderUnit(job, worker, unit); };
  const auto is_sound = [&](const UnitId& unit) { return !job.troubles.contains(unit); };
  std::optional<UnitId> unit = job.queue->Next(may_render);
  if (!unit) return false;
  const bool alone = !is_sound(*unit);

  const WorkerRate& rate = worker.rates[job.id];
  LeaseSizing sizing;
  if (rate.seconds > 0) sizing.samples_per_second = rate.samples / rate.seconds;
  sizing.samples_per_unit =
      static_cast<double>(job.planned_samples) / static_cast<double>(job.planned_units);
  sizing.pending_units = job.queue->Pending();
  sizing.workers = static_cast<int>(workers.size());
  const uint64_t wanted = alone ? 1 : UnitsForLease(sizing);

  std::vector<UnitId> units;
  while (unit) {
    job.queue->Take(*unit);
    units.push_back(*unit);
    if (units.size() >= wanted) break;
    unit = job.queue->Next(is_sound);
  }
  Grant(job, worker, std::move(units), now);
  return true;
}

bool Farm::State::GrantDuplicate(WorkerRecord& worker, SteadyTime now) {
  const auto may_render = [&](const JobId& id) STRATA_REQUIRES(mutex) {
    const JobRecord& job = *jobs.at(id);
    return job.state == JobState::kRunning && MayRender(job, worker);
  };
  const auto straggler = PickStraggler(leases, worker.id, now, may_render);
  if (!straggler) return false;
  Grant(*jobs.at(straggler->first), worker, {straggler->second}, now);
  return true;
}

void Farm::State::Grant(JobRecord& job, WorkerRecord& worker, std::vector<UnitId> units,
                        SteadyTime now) {
  if (!job.worker_class) job.worker_class = ClassOf(worker.hello);
  if (!job.first_lease) job.first_lease = now;
  if (job.state == JobState::kQueued) SetState(job, JobState::kRunning, "", now);
  if (worker.described.insert(job.id).second) {
    worker.link->Send(JobDescription{job.id, job.spec});
  }
  const LeaseRecord& record = leases.Grant(job.id, worker.id, std::move(units), now);
  Lease lease{job.id, record.id, {}};
  for (const UnitId& unit : record.units) lease.units.push_back(*job.plan->Unit(unit));
  worker.link->Send(std::move(lease));
}

}  // namespace strata
