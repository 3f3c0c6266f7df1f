// What workers send, and merging it.

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "coordinator/farm_state.h"
#include "coordinator/partial_check.h"

namespace strata {
namespace {

constexpr uint64_t kReplaysLogged = 20;

uint64_t SamplesIn(const Partial& partial) {
  return std::accumulate(partial.samples.begin(), partial.samples.end(), uint64_t{0}) * kReplicates;
}

}  // namespace

void Farm::Receive(const std::string& worker, FromWorker message, SteadyTime now) {
  {
    MutexLock lock(state_->mutex);
    state_->Seen(now);
    const auto entry = state_->workers.find(worker);
    if (entry == state_->workers.end()) return;
    WorkerRecord& record = *entry->second;
    record.heard = std::max(record.heard, now);
    ++record.receiving;
    if (std::exchange(record.lost, false)) {
      spdlog::info("worker {} is heard again", worker);
      state_->Dispatch(now);
    }
    if (std::holds_alternative<Draining>(message)) record.draining = true;
  }
  if (auto* result = std::get_if<UnitResult>(&message)) {
    state_->ReceiveResult(worker, std::move(*result), now);
  } else if (auto* failure = std::get_if<UnitFailure>(&message)) {
    state_->ReceiveFailure(worker, std::move(*failure), now);
  } else if (const auto* request = std::get_if<FileRequest>(&message)) {
    state_->ReceiveRequest(worker, *request);
  }
  MutexLock lock(state_->mutex);
  const auto entry = state_->workers.find(worker);
  if (entry != state_->workers.end()) --entry->second->receiving;
}

void Farm::State::ReceiveRequest(const std::string& worker, const FileRequest& request) {
  std::shared_ptr<WorkerLink> link;
  {
    MutexLock lock(mutex);
    const auto entry = workers.find(worker);
    if (entry == workers.end()) return;
    link = entry->second->link;
  }
  absl::StatusOr<FileStore::Chunk> chunk =
      files.Read(request.digest, request.offset, kFileChunkBytes);
  FileChunk answer{request.digest, request.offset, 0, "", ""};
  if (chunk.ok()) {
    answer.total = chunk->total;
    answer.data = std::move(chunk->data);
  } else {
    answer.error = std::string(chunk.status().message());
  }
  link->Send(std::move(answer));
}

void Farm::State::ReceiveResult(const std::string& worker, UnitResult result, SteadyTime now) {
  std::shared_ptr<const RoundPlan> plan;
  std::shared_ptr<JobFilm> film;
  PixelLayout layout;
  uint32_t window = 0;
  {
    MutexLock lock(mutex);
    const auto entry = jobs.find(result.job);
    if (entry == jobs.end()) return;
    const JobRecord& job = *entry->second;
    // Of an ended job, of an earlier round, or of one that is merged or dropped: late, and known
    // already or not wanted.
    if (IsFinal(job.state) || job.finishing || result.partial.unit.round < job.plan->round) return;
    plan = job.plan;
    film = job.film;
    layout = LayoutOf(job.spec);
    window = job.queue->window();
  }
  const JobId job = result.job;
  const UnitId unit = result.partial.unit;
  const std::optional<WorkUnit> planned = plan->Unit(unit);
  const absl::Status status = planned ? CheckPartial(result.partial, *planned, layout)
                                      : absl::InvalidArgumentError("its unit is not in the plan");
  if (!status.ok()) {
    RefusePartial(worker, job, unit, std::string(status.message()), now);
  } else if (MergeResult(worker, std::move(result), plan, *film, window, now)) {
    FinishRound(job, now);
  }
}

bool Farm::State::MergeResult(const std::string& worker, UnitResult result,
                              const std::shared_ptr<const RoundPlan>& plan, JobFilm& film,
                              uint32_t window, SteadyTime now) {
  const UnitId unit = result.partial.unit;
  const uint64_t samples = SamplesIn(result.partial);
  const uint64_t rays =
      std::accumulate(result.partial.rays.begin(), result.partial.rays.end(), uint64_t{0});
  UnitResult summary{result.job, result.lease, {}, result.load_seconds, result.background_pixels};
  summary.partial.unit = unit;
  summary.partial.replays = std::move(result.partial.replays);
  summary.partial.render_seconds = result.partial.render_seconds;
  OrderedMerge::Result added;
  {
    MutexLock lock(film.mutex);
    if (!film.merge) return false;
    added = film.merge->Add(std::move(result.partial), window);
    if (added.outcome == OrderedMerge::Outcome::kMerged) film.changed[unit.tile] = true;
  }

  MutexLock lock(mutex);
  const auto entry = jobs.find(summary.job);
  if (entry == jobs.end()) return false;
  JobRecord& job = *entry->second;
  // Dropped meanwhile, the round is in the film no more; see FinishDropped.
  if (job.plan != plan) return false;
  const auto from = workers.find(worker);
  if (added.outcome == OrderedMerge::Outcome::kTooEarly) {
    if (leases.GiveUp(worker, job.id, unit) && leases.Holders(job.id, unit) == 0) {
      job.queue->Return(unit);
    }
    Dispatch(now);
    return false;
  }
  if (added.outcome != OrderedMerge::Outcome::kKnown) {
    if (from != workers.end()) MeasureWorker(job, *from->second, summary, samples, now);
    LogNonFinite(job, summary.partial.replays);
    job.received_samples += samples;
    job.received_cost += static_cast<double>(rays + samples);
    job.troubles.erase(unit);
    job.queue->Received(unit, added.front);
  }
  std::vector<std::string> may_hold_more = {worker};
  for (const LeaseRecord& emptied : leases.Finish(job.id, unit)) {
    if (emptied.worker != worker) may_hold_more.push_back(emptied.worker);
    const auto holder = workers.find(emptied.worker);
    if (emptied.worker != worker && holder != workers.end()) {
      holder->second->link->Send(CancelLease{emptied.id});
    }
  }
  if (added.outcome == OrderedMerge::Outcome::kMerged) {
    job.merged.units += added.merged.units;
    job.merged.samples += added.merged.samples;
    job.merged.rays += added.merged.rays;
    job.merged.nonfinite += added.merged.nonfinite;
    job.last_merge = now;
    job.summary_stale = true;
    job.rate.Tell(static_cast<double>(job.merged.samples), now);
  }
  DispatchTo(may_hold_more, now);
  return BeginFinish(job);
}

void Farm::State::MeasureWorker(JobRecord& job, WorkerRecord& worker, const UnitResult& result,
                                uint64_t samples, SteadyTime now) {
  worker.samples += samples;
  job.load_s = std::max(job.load_s, result.load_seconds);
  job.background_pixels = std::min(result.background_pixels, job.spec.crop.Pixels());
  const std::chrono::duration<double> render(std::max(result.partial.render_seconds, 0.0));
  const SteadyTime began = now - std::chrono::duration_cast<SteadyTime::duration>(render);
  job.render_began =
      std::max(std::min(job.render_began.value_or(began), began), job.first_lease.value_or(began));
  const auto lease = leases.leases().find(result.lease);
  if (lease == leases.leases().end()) return;
  const SteadyTime granted = lease->second.granted;
  WorkerRate& rate = worker.rates[job.id];
  const SteadyTime since = std::max(granted, std::exchange(worker.rendered, now));
  if (!std::exchange(rate.warm, true)) return;  // It took the loading of the scene too.
  constexpr double kMemorySeconds = 8;
  rate.samples += static_cast<double>(samples);
  rate.seconds += SecondsBetween(since, now);
  if (rate.seconds > kMemorySeconds) {
    rate.samples /= 2;
    rate.seconds /= 2;
  }
}

void Farm::State::LogNonFinite(JobRecord& job, const std::vector<std::string>& replays) {
  for (const std::string& replay : replays) {
    if (job.replays_logged++ >= kReplaysLogged) return;
    Log(job, "warning", fmt::format("a sample was not finite; replay it with: {}", replay));
  }
}

}  // namespace strata
