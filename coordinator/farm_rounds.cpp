// From round to round, and to the end.

#include <fmt/format.h>

#include <system_error>
#include <utility>

#include "coordinator/allocation.h"
#include "coordinator/confidence_sequence.h"
#include "coordinator/farm_state.h"
#include "coordinator/round_plan_format.h"
#include "coordinator/schedule.h"

namespace strata {
namespace {

/// Before the pilot is merged nobody knows what a target takes. For the fraction shown alone.
constexpr double kTargetToPilot = 4;

double ExpectedSamples(const JobSpec& spec, uint64_t planned) {
  if (spec.target != TargetKind::kSamples) return kTargetToPilot * static_cast<double>(planned);
  return static_cast<double>(spec.spp) * static_cast<double>(spec.crop.Pixels());
}

/// What the interval at a fixed count is multiplied with to hold from the first piece of a pixel to
/// the last it may get.
double WideningWhileWatched(const RoundPlan& first, const JobSpec& spec) {
  const double pilot = kReplicates * static_cast<double>(first.classes[0].pieces[0].Count());
  const bool known = IsLastRound(spec, 1);
  const double most = known ? spec.spp : kMostOfAverage * static_cast<double>(spec.spp);
  return AnytimeFactor(pilot, most) / kStudent25;
}

/// A round like `plan` in which nothing is rendered.
RoundPlan EmptyRound(const RoundPlan& plan) { return {plan.round, plan.grid, {{}}, {}}; }

/// Keeps the film as it is in a file of its own.
absl::Status KeepFilm(const JobFilm& film, const std::filesystem::path& path,
                      const std::filesystem::path& kept) {
  MutexLock lock(film.mutex);  // The mapping and the file are one, as long as nobody writes.
  std::error_code error;
  std::filesystem::copy_file(path, kept, std::filesystem::copy_options::overwrite_existing, error);
  if (!error) return absl::OkStatus();
  return absl::ResourceExhaustedError(fmt::format("{}: {}", kept.string(), error.message()));
}

/// Puts the kept film back. No result is merged any more.
absl::Status RestoreFilm(JobFilm& film, const std::filesystem::path& path,
                         const std::filesystem::path& kept) {
  MutexLock lock(film.mutex);
  film.merge.reset();
  std::error_code error;
  std::filesystem::rename(kept, path, error);
  if (error) return absl::DataLossError(fmt::format("{}: {}", kept.string(), error.message()));
  STRATA_ASSIGN_OR_RETURN(film.film, Film::Open(path));
  film.changed.assign(film.changed.size(), true);
  return absl::OkStatus();
}

}  // namespace

std::filesystem::path FilmPath(const FarmOptions& options, const JobId& job) {
  return options.state_dir / "films" / (job + ".film");
}

std::filesystem::path KeptFilmPath(const FarmOptions& options, const JobId& job) {
  return options.state_dir / "films" / (job + ".kept.film");
}

PreparedRound::PreparedRound(RoundPlan made)
    : plan(std::make_shared<const RoundPlan>(std::move(made))),
      bytes(EncodeRoundPlan(*plan)),
      samples(plan->Samples()),
      units(plan->Units()),
      queue(std::make_unique<UnitQueue>(plan, 0)) {}

absl::Status Farm::State::StartRound(JobRecord& job, PreparedRound round) {
  STRATA_RETURN_IF_ERROR(store->SaveRound(job.id, round.plan->round, round.bytes));
  job.plan = std::move(round.plan);
  job.queue = std::move(round.queue);
  job.queue->WidenWindow(WindowFor(job.plan->grid.Count(), static_cast<int>(workers.size())));
  job.merged_before = job.merged;
  job.planned_samples += round.samples;
  job.planned_units += round.units;
  if (job.plan->round == 0) {
    job.expected.expected = ExpectedSamples(job.spec, job.planned_samples);
    job.widening = WideningWhileWatched(*job.plan, job.spec);
  }
  MutexLock lock(job.film->mutex);
  job.film->merge = std::make_unique<OrderedMerge>(*job.film->film, job.plan);
  return absl::OkStatus();
}

bool Farm::State::BeginFinish(JobRecord& job) {
  const bool complete = job.merged.units == job.planned_units && !job.finishing;
  job.finishing |= complete;
  return complete;
}

std::optional<SteadyTime> Farm::State::Deadline(const JobRecord& job) const {
  if (job.spec.target != TargetKind::kTime || !job.first_lease) return std::nullopt;
  // Beyond a century a deadline is none, and its ticks do not fit.
  constexpr double kLongest = 3e9;
  if (job.spec.target_value > kLongest) return std::nullopt;
  return *job.first_lease + std::chrono::duration_cast<SteadyTime::duration>(
                                std::chrono::duration<double>(job.spec.target_value));
}

void Farm::State::FinishRound(const JobId& id, SteadyTime now) {
  std::shared_ptr<JobFilm> film;
  JobSpec spec;
  uint32_t finished = 0;
  TimeLeft left;
  {
    MutexLock lock(mutex);
    const absl::StatusOr<JobRecord*> found = Find(id);
    if (!found.ok()) return;
    JobRecord& job = **found;
    film = job.film;
    spec = job.spec;
    finished = job.rounds = job.plan->round + 1;
    if (const std::optional<SteadyTime> deadline = Deadline(job)) {
      left.seconds = SecondsBetween(now, *deadline);
      const double rendered = SecondsBetween(job.render_began.value_or(now), now);
      if (rendered > 0) left.rays_per_second = static_cast<double>(job.merged.rays) / rendered;
    }
    if (IsLastRound(spec, finished)) job.target_met = true;
  }
  if (IsLastRound(spec, finished)) return Complete(id, "", now);

  PixelStatistics statistics;
  {
    MutexLock lock(film->mutex);
    statistics = GatherPixelStatistics(*film->film);
  }
  NextRound next = PlanNextRound(spec, finished, statistics, left);
  std::string message;
  if (next.plan && spec.target == TargetKind::kTime) {
    const absl::Status kept = KeepFilm(*film, FilmPath(options, id), KeptFilmPath(options, id));
    if (!kept.ok()) {
      message = fmt::format("no further round, as this one could not be kept: {}",
                            std::string(kept.message()));
      next.plan.reset();
    }
  }
  std::optional<PreparedRound> prepared;
  if (next.plan) prepared.emplace(*std::move(next.plan));
  {
    MutexLock lock(mutex);
    const absl::StatusOr<JobRecord*> found = Find(id);
    if (!found.ok()) return;
    JobRecord& job = **found;
    job.target_met = next.target_met;
    job.target_share = next.target_share;
    job.expected = {static_cast<double>(job.merged.samples) + next.samples_left, next.deviation};
    if (prepared) {
      job.finishing = false;
      Log(job, "info", fmt::format("round {}: {} samples", finished, prepared->samples));
      // Also of a job that was cancelled meanwhile: when it is retried, it goes on with this plan.
      const absl::Status status = StartRound(job, *std::move(prepared));
      if (!status.ok()) EndJob(job, JobState::kFailed, std::string(status.message()), now);
      Dispatch(now);
      return;
    }
  }
  Complete(id, message, now);
}

std::vector<JobId> Farm::State::BeginDrops(SteadyTime now) {
  std::vector<JobId> dropped;
  for (auto& [id, job] : jobs) {
    const std::optional<SteadyTime> deadline = Deadline(*job);
    // The first round is never dropped: there would be no picture.
    if (!deadline || now < *deadline || job->state != JobState::kRunning || job->finishing ||
        job->plan->round == 0) {
      continue;
    }
    job->finishing = true;
    dropped.push_back(id);
  }
  return dropped;
}

void Farm::State::FinishDropped(const JobId& id, SteadyTime now) {
  std::shared_ptr<JobFilm> film;
  {
    MutexLock lock(mutex);
    const absl::StatusOr<JobRecord*> job = Find(id);
    if (!job.ok()) return;
    film = (*job)->film;
  }
  const absl::Status restored =
      RestoreFilm(*film, FilmPath(options, id), KeptFilmPath(options, id));
  std::string message;
  {
    MutexLock lock(mutex);
    const absl::StatusOr<JobRecord*> found = Find(id);
    if (!found.ok()) return;
    JobRecord& job = **found;
    if (!restored.ok()) {
      job.finishing = false;
      return EndJob(job, JobState::kFailed, std::string(restored.message()), now);
    }
    message =
        fmt::format("time is up: {} rounds are whole, and {} samples of the next were dropped",
                    job.rounds, job.merged.samples - job.merged_before.samples);
    job.merged = job.merged_before;
    job.planned_samples -= job.plan->Samples();
    job.planned_units -= job.plan->Units();
    // From here on the round has nothing to lease.
    leases.RemoveJob(id);
    job.plan = std::make_shared<const RoundPlan>(EmptyRound(*job.plan));
    job.queue = std::make_unique<UnitQueue>(job.plan, job.queue->window());
    job.target_met = true;
  }
  Complete(id, message, now);
}

void Farm::State::Complete(const JobId& id, const std::string& message, SteadyTime now) {
  std::shared_ptr<JobFilm> film;
  {
    MutexLock lock(mutex);
    const absl::StatusOr<JobRecord*> job = Find(id);
    if (!job.ok()) return;
    film = (*job)->film;
  }
  const FilmSummary summary = RefreshSummary(*film, 1);
  Digest digest;
  {
    MutexLock lock(film->mutex);
    digest = film->film->ResultDigest();
  }
  {
    MutexLock lock(mutex);
    const absl::StatusOr<JobRecord*> found = Find(id);
    if (!found.ok()) return;
    JobRecord& job = **found;
    job.summary = summary;
    job.summary_stale = false;
    job.result = digest;
    job.finishing = false;
    job.summary_held = true;
    if (IsFinal(job.state)) return;  // Cancelled meanwhile.
    std::error_code error;           // Left behind, it is removed with the job.
    std::filesystem::remove(KeptFilmPath(options, id), error);
    std::string told = message;
    if (job.merged.nonfinite > 0) {
      told = fmt::format("{} samples were not finite and entered as zero; see the log",
                         job.merged.nonfinite);
    }
    EndJob(job, JobState::kDone, told, now);
    Dispatch(now);
  }
  Publish(id);
}

}  // namespace strata
