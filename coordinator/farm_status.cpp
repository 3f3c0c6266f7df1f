// What clients are told.

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "coordinator/farm_state.h"

namespace strata {
namespace {

/// Status of a job in progress goes to its subscribers this often at most.
constexpr std::chrono::milliseconds kPublishPeriod{250};

std::string StateText(const WorkerRecord& worker, int leases) {
  if (worker.lost) return "lost";
  if (worker.draining) return "draining";
  return leases > 0 ? "busy" : "idle";
}

/// The tiles to estimate anew: those that changed and their neighbours, whose borders depend on
/// them.
std::vector<bool> WithNeighbours(const std::vector<bool>& changed, const TileGrid& grid) {
  std::vector<bool> touched(changed.size());
  const int columns = static_cast<int>(grid.Columns()), rows = static_cast<int>(grid.Rows());
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) {
      if (!changed[static_cast<size_t>(y * columns + x)]) continue;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, rows - 1); ++v) {
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, columns - 1); ++u) {
          touched[static_cast<size_t>(v * columns + u)] = true;
        }
      }
    }
  }
  return touched;
}

}  // namespace

FilmSummary RefreshSummary(JobFilm& film, double widening) {
  MutexLock summary_lock(film.summary_mutex);
  std::vector<bool> touched;
  TileGrid grid;
  {
    MutexLock lock(film.mutex);
    grid = film.film->geometry().grid;
    if (!film.summary) {
      film.summary = std::make_unique<SummaryInput>(grid);
      film.changed.assign(film.changed.size(), true);
    }
    touched = WithNeighbours(film.changed, grid);
    film.changed.assign(film.changed.size(), false);
  }
  for (uint32_t tile = 0; tile < touched.size(); ++tile) {
    if (!touched[tile]) continue;
    EstimateInput input;
    {
      MutexLock lock(film.mutex);
      input = GatherEstimateInput(*film.film, grid.Rect(tile), film.sampler);
    }
    film.summary->Update(tile, Estimate(input));
  }
  return film.summary->Summarize(widening);
}

void ReleaseSummary(JobFilm& film) {
  MutexLock lock(film.summary_mutex);
  film.summary.reset();
}

JobStatus Farm::State::StatusOf(const JobRecord& job) const {
  JobStatus status;
  status.id = job.id;
  status.spec = job.spec;
  status.state = job.state;
  status.message = job.message;
  if (status.message.empty() && !IsFinal(job.state)) status.message = WaitReason(job);
  status.fraction = FractionOf(job);
  status.samples = job.merged.samples;
  status.rays = job.merged.rays;
  status.nonfinite = job.merged.nonfinite;
  status.spp_mean =
      static_cast<double>(job.merged.samples) / static_cast<double>(job.spec.crop.Pixels());
  status.rel_error = job.summary.rel_error;
  status.flagged = job.summary.flagged;
  std::copy_n(job.summary.mean_rgb, kColours, status.mean_rgb);
  status.worst_tiles = job.summary.worst_tiles;
  status.submitted_unix_s = job.submitted_unix_s;
  status.wall_s = SecondsBetween(job.submitted, job.ended.value_or(latest));
  status.load_s = job.load_s;
  status.background_pixels = job.background_pixels;
  if (job.render_began && job.last_merge) {
    status.render_s = std::max(SecondsBetween(*job.render_began, *job.last_merge), 0.0);
  }
  status.workers = leases.Workers(job.id);
  status.samples_per_second = job.rate.PerSecond();
  status.rounds = job.rounds;
  status.target_met = job.target_met;
  status.target_share = job.target_share;
  AddTimeLeft(job, status);
  status.result = job.result;
  return status;
}

double Farm::State::FractionOf(const JobRecord& job) const {
  if (job.state == JobState::kDone) return 1;
  const double merged = static_cast<double>(job.merged.samples);
  const double of_samples =
      merged / std::max(job.expected.expected, static_cast<double>(job.planned_samples));
  const std::optional<SteadyTime> deadline = Deadline(job);
  if (!deadline) return of_samples;
  const double of_time = SecondsBetween(*job.first_lease, latest) / job.spec.target_value;
  return std::clamp(std::max(of_samples, of_time), 0.0, 1.0);
}

void Farm::State::AddTimeLeft(const JobRecord& job, JobStatus& status) const {
  if (IsFinal(job.state)) {
    status.eta_s = status.eta_low_s = status.eta_high_s = status.samples_left = 0;
    return;
  }
  if (const std::optional<SteadyTime> deadline = Deadline(job)) {
    status.eta_s = status.eta_low_s = status.eta_high_s =
        std::max(SecondsBetween(latest, *deadline), 0.0);
    return;
  }
  // What a target takes is unknown until the pilot is merged.
  if (job.spec.target != TargetKind::kSamples && job.plan->round == 0) return;
  const double expected = std::max(job.expected.expected, static_cast<double>(job.planned_samples));
  const RemainingSamples remaining{expected - static_cast<double>(job.merged.samples),
                                   job.expected.deviation};
  status.samples_left = remaining.expected;
  const TimeToTarget time = PredictTimeToTarget(remaining, job.rate.Spans());
  status.eta_s = time.seconds;
  if (time.seconds < 0) return;
  status.eta_low_s = time.low_seconds;
  status.eta_high_s = time.high_seconds;
}

std::string Farm::State::WaitReason(const JobRecord& job) const {
  if (job.state == JobState::kPaused || !WorkersFor(job).empty()) return "";
  if (workers.empty()) return "waits for a worker";
  for (const auto& [id, worker] : workers) {
    if (worker->lost || worker->draining || !job.worker_class) continue;
    const std::string difference = Difference(ClassOf(worker->hello), *job.worker_class);
    if (!difference.empty()) {
      return fmt::format("waits for a worker like those it began with: {} has {}", id, difference);
    }
  }
  return "waits for a worker: all are lost or leaving";
}

void Farm::State::Publish(const JobId& id) {
  {
    MutexLock lock(mutex);
    const auto job = jobs.find(id);
    if (job == jobs.end()) return;
    JobRecord& record = *job->second;
    if (!IsFinal(record.state) && latest - record.published < kPublishPeriod) return;
    record.published = latest;
  }
  subscriptions.Deliver(id, [&] {
    MutexLock lock(mutex);
    const auto job = jobs.find(id);
    return job == jobs.end() ? std::nullopt : std::optional(StatusOf(*job->second));
  });
}

absl::StatusOr<JobStatus> Farm::Get(const JobId& id) const {
  MutexLock lock(state_->mutex);
  STRATA_ASSIGN_OR_RETURN(const JobRecord* job, state_->Find(id));
  return state_->StatusOf(*job);
}

std::vector<JobStatus> Farm::List() const {
  MutexLock lock(state_->mutex);
  std::vector<std::pair<uint64_t, JobStatus>> jobs;
  for (const auto& [id, job] : state_->jobs) {
    jobs.emplace_back(job->number, state_->StatusOf(*job));
  }
  std::sort(jobs.begin(), jobs.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<JobStatus> statuses;
  for (auto& [number, status] : jobs) statuses.push_back(std::move(status));
  return statuses;
}

absl::StatusOr<uint64_t> Farm::Subscribe(const JobId& job,
                                         std::function<void(const JobStatus&)> on_change) {
  MutexLock lock(state_->mutex);
  STRATA_RETURN_IF_ERROR(state_->Find(job).status());
  return state_->subscriptions.Add(job, std::move(on_change));
}

void Farm::Unsubscribe(uint64_t handle) { state_->subscriptions.Remove(handle); }

std::vector<WorkerStatus> Farm::Workers(SteadyTime now) const {
  MutexLock lock(state_->mutex);
  std::vector<WorkerStatus> statuses;
  for (const auto& [id, worker] : state_->workers) {
    const int leases = state_->leases.Count(id);
    WorkerStatus status;
    status.id = id;
    status.name = worker->hello.name;
    status.state = StateText(*worker, leases);
    status.tags = worker->hello.tags;
    status.threads = worker->hello.threads;
    status.leases = leases;
    status.samples = worker->samples;
    status.connected_s = SecondsBetween(worker->connected, now);
    status.silent_s = SecondsBetween(worker->heard, now);
    status.build = worker->hello.build;
    statuses.push_back(std::move(status));
  }
  return statuses;
}

}  // namespace strata
