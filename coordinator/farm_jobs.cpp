// Jobs: submission, control, files, logs, images.

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <system_error>
#include <utility>

#include "coordinator/farm_state.h"
#include "coordinator/image.h"

namespace strata {
namespace {

double UnixNow() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

absl::Status Unknown(const JobId& job) {
  return absl::NotFoundError(fmt::format("job {} does not exist", job));
}

absl::Status WrongState(const JobRecord& job, std::string_view remedy) {
  return absl::FailedPreconditionError(
      fmt::format("job {} is {}; {}", job.id, ToString(job.state), remedy));
}

/// A request that came again, perhaps since its answer was lost, must ask for the same.
absl::StatusOr<JobId> SameJob(const JobRecord& job, JobSpec spec) {
  spec.priority = job.spec.priority;  // It may have been changed since.
  if (spec == job.spec) return job.id;
  return absl::AlreadyExistsError(
      fmt::format("request_id: it was used for job {}, which is another one", job.id));
}

/// Makes the directory of films; removes those of an earlier life that no job in the store owns.
absl::Status PrepareDirectory(const FarmOptions& options, const JobStore& store) {
  STRATA_ASSIGN_OR_RETURN(const std::vector<StoredJob> jobs, store.Jobs());
  absl::flat_hash_set<std::string> owned;
  for (const StoredJob& job : jobs) owned.insert(FilmPath(options, job.id).filename());
  const std::filesystem::path films = options.state_dir / "films";
  std::error_code error;
  std::filesystem::create_directories(films, error);
  if (error) return absl::UnavailableError(fmt::format("{}: {}", films.string(), error.message()));
  for (const auto& entry : std::filesystem::directory_iterator(films, error)) {
    const std::filesystem::path& path = entry.path();
    if (path.extension() == ".film" && !owned.contains(path.filename().string())) {
      std::filesystem::remove(path, error);
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<std::unique_ptr<Farm>> Farm::Create(FarmOptions options,
                                                   std::unique_ptr<JobStore> store) {
  STRATA_ASSIGN_OR_RETURN(std::unique_ptr<DirectoryLock> directory_lock,
                          DirectoryLock::Take(options.state_dir));
  STRATA_RETURN_IF_ERROR(PrepareDirectory(options, *store));
  STRATA_ASSIGN_OR_RETURN(FileStore files, FileStore::Create(options.state_dir / "files"));
  auto state = std::make_unique<State>(std::move(options), std::move(directory_lock),
                                       std::move(store), std::move(files));
  return std::unique_ptr<Farm>(new Farm(std::move(state)));
}

Farm::Farm(std::unique_ptr<State> state) : state_(std::move(state)) {}
Farm::~Farm() = default;

std::vector<Digest> Farm::MissingFiles(const std::vector<Digest>& digests) const {
  std::vector<Digest> missing;
  for (const Digest& digest : digests) {
    if (!state_->files.Contains(digest)) missing.push_back(digest);
  }
  return missing;
}

absl::StatusOr<std::unique_ptr<Farm::FileUpload>> Farm::BeginUpload(const Digest& digest,
                                                                    uint64_t bytes) {
  return state_->files.BeginUpload(digest, bytes);
}

absl::StatusOr<JobId> Farm::Submit(const JobSpec& spec, const std::string& request_id,
                                   SteadyTime now) {
  STRATA_RETURN_IF_ERROR(ValidateJobSpec(spec));
  for (const BundleFile& file : spec.bundle.files) {
    if (!state_->files.Contains(file.digest)) {
      return absl::FailedPreconditionError(
          fmt::format("{}: the coordinator does not have this file; upload it first", file.path));
    }
  }
  MutexLock lock(state_->mutex);
  state_->Seen(now);
  return state_->AddJob(spec, request_id, now);
}

absl::StatusOr<JobId> Farm::State::AddJob(const JobSpec& spec, const std::string& request_id,
                                          SteadyTime now) {
  if (!request_id.empty()) {
    STRATA_ASSIGN_OR_RETURN(const std::optional<JobId> known, store->FindRequest(request_id));
    if (known) return SameJob(*jobs.at(*known), spec);
  }
  auto job = std::make_unique<JobRecord>();
  job->spec = spec;
  job->number = ++last_job_number;
  job->submitted = now;
  job->submitted_unix_s = UnixNow();
  STRATA_ASSIGN_OR_RETURN(job->id, store->AddJob(spec, request_id, job->submitted_unix_s));
  if (const absl::Status status = Prepare(*job); !status.ok()) {
    store->DeleteJob(job->id).IgnoreError();
    return status;
  }
  const JobId id = job->id;
  Log(*job, "info",
      fmt::format("submitted: {} pixels, {} samples each", spec.crop.Pixels(), spec.spp));
  if (spec.allocation == AllocationKind::kGreedy) {
    Log(*job, "warning", "allocation greedy is biased: it is for comparison only");
  }
  LevelService(*(jobs[id] = std::move(job)));
  Dispatch(now);
  return id;
}

absl::Status Farm::State::Prepare(JobRecord& job) {
  const FilmGeometry geometry{FilmLayer::kPath, {job.spec.crop, job.spec.tile}, LayoutOf(job.spec)};
  job.film = std::make_shared<JobFilm>(job.spec.sampler);
  {
    MutexLock lock(job.film->mutex);
    STRATA_ASSIGN_OR_RETURN(job.film->film, Film::Create(FilmPath(options, job.id), geometry));
    job.film->changed.resize(geometry.grid.Count());
  }
  return StartRound(job, PreparedRound(PlanFirstRound(job.spec)));
}

absl::StatusOr<JobRecord*> Farm::State::Find(const JobId& job) {
  const auto entry = jobs.find(job);
  if (entry == jobs.end()) return Unknown(job);
  return entry->second.get();
}

void Farm::State::Seen(SteadyTime now) { latest = std::max(latest, now); }

void Farm::State::Log(const JobRecord& job, std::string_view level, const std::string& text) {
  const absl::Status status = store->AppendLog(job.id, {UnixNow(), std::string(level), text});
  if (!status.ok()) spdlog::error("job {}: log: {}", job.id, std::string(status.message()));
  spdlog::log(spdlog::level::from_str(std::string(level)), "job {}: {}", job.id, text);
}

void Farm::State::SetState(JobRecord& job, JobState state, const std::string& message,
                           SteadyTime now) {
  job.state = state;
  job.message = message;
  if (IsFinal(state)) job.ended = now;
  const absl::Status status = store->SetState(job.id, state, message);
  if (!status.ok()) spdlog::error("job {}: state: {}", job.id, std::string(status.message()));
  Log(job, state == JobState::kFailed ? "error" : "info",
      message.empty() ? std::string(ToString(state))
                      : fmt::format("{}: {}", ToString(state), message));
}

void Farm::State::EndJob(JobRecord& job, JobState state, const std::string& message,
                         SteadyTime now) {
  for (const LeaseRecord& lease : leases.RemoveJob(job.id)) {
    for (const UnitId& unit : lease.units) job.queue->Return(unit);
  }
  for (auto& [id, worker] : workers) {
    worker->rates.erase(job.id);
    if (worker->described.erase(job.id) > 0) worker->link->Send(CancelJob{job.id});
  }
  job.rate.Clear();
  SetState(job, state, message, now);
}

absl::Status Farm::Cancel(const JobId& id, SteadyTime now) {
  {
    MutexLock lock(state_->mutex);
    state_->Seen(now);
    STRATA_ASSIGN_OR_RETURN(JobRecord * job, state_->Find(id));
    if (job->state == JobState::kCancelled) return absl::OkStatus();
    if (IsFinal(job->state)) return WrongState(*job, "there is nothing to cancel");
    state_->EndJob(*job, JobState::kCancelled, "", now);
    state_->Dispatch(now);
  }
  state_->Publish(id);
  return absl::OkStatus();
}

absl::Status Farm::Pause(const JobId& id, SteadyTime now) {
  {
    MutexLock lock(state_->mutex);
    state_->Seen(now);
    STRATA_ASSIGN_OR_RETURN(JobRecord * job, state_->Find(id));
    if (job->state == JobState::kPaused) return absl::OkStatus();
    if (IsFinal(job->state)) return WrongState(*job, "there is nothing to pause");
    // Leases that are out end by themselves within seconds; their results are merged.
    state_->SetState(*job, JobState::kPaused, "", now);
    state_->Dispatch(now);
  }
  state_->Publish(id);
  return absl::OkStatus();
}

absl::Status Farm::Resume(const JobId& id, SteadyTime now) {
  {
    MutexLock lock(state_->mutex);
    state_->Seen(now);
    STRATA_ASSIGN_OR_RETURN(JobRecord * job, state_->Find(id));
    if (IsFinal(job->state)) return WrongState(*job, "use retry to start it again");
    if (job->state != JobState::kPaused) return absl::OkStatus();
    state_->Requeue(*job, now);
  }
  state_->Publish(id);
  return absl::OkStatus();
}

absl::Status Farm::Retry(const JobId& id, SteadyTime now) {
  bool complete = false;
  {
    MutexLock lock(state_->mutex);
    state_->Seen(now);
    STRATA_ASSIGN_OR_RETURN(JobRecord * job, state_->Find(id));
    if (job->state != JobState::kFailed && job->state != JobState::kCancelled) {
      return WrongState(*job, "only a failed or cancelled job can be retried");
    }
    job->troubles.clear();
    job->job_failures.clear();
    job->ended.reset();
    state_->Requeue(*job, now);
    complete = state_->BeginFinish(*job);  // It was cancelled while its last figures were made.
  }
  if (complete) state_->FinishRound(id, now);
  state_->Publish(id);
  return absl::OkStatus();
}

void Farm::State::Requeue(JobRecord& job, SteadyTime now) {
  SetState(job, job.received_samples > 0 ? JobState::kRunning : JobState::kQueued, "", now);
  LevelService(job);
  Dispatch(now);
}

absl::Status Farm::Delete(const JobId& id) {
  state_->Publish(id);  // The end, to those who were to hear of it with the next tick.
  MutexLock lock(state_->mutex);
  STRATA_ASSIGN_OR_RETURN(JobRecord * job, state_->Find(id));
  if (!IsFinal(job->state)) return WrongState(*job, "cancel it first");
  STRATA_RETURN_IF_ERROR(state_->store->DeleteJob(id));
  std::error_code error;  // A film that stays behind is removed at the next start.
  std::filesystem::remove(FilmPath(state_->options, id), error);
  std::filesystem::remove(KeptFilmPath(state_->options, id), error);
  state_->jobs.erase(id);
  return absl::OkStatus();
}

absl::Status Farm::SetPriority(const JobId& id, int priority, SteadyTime now) {
  {
    MutexLock lock(state_->mutex);
    state_->Seen(now);
    STRATA_ASSIGN_OR_RETURN(JobRecord * job, state_->Find(id));
    JobSpec changed = job->spec;
    changed.priority = priority;
    STRATA_RETURN_IF_ERROR(ValidateJobSpec(changed));
    STRATA_RETURN_IF_ERROR(state_->store->SetPriority(id, priority));
    job->spec.priority = priority;
    state_->Log(*job, "info", fmt::format("priority {}", priority));
    state_->LevelService(*job);
    state_->Dispatch(now);
  }
  state_->Publish(id);
  return absl::OkStatus();
}

absl::StatusOr<std::vector<LogLine>> Farm::Logs(const JobId& job) const {
  MutexLock lock(state_->mutex);
  return state_->store->Log(job);
}

absl::StatusOr<ImageLayers> Farm::Image(const JobId& id) const {
  std::shared_ptr<JobFilm> film;
  JobStatus status;
  double widening = 1;
  {
    MutexLock lock(state_->mutex);
    STRATA_ASSIGN_OR_RETURN(const JobRecord* job, state_->Find(id));
    film = job->film;
    status = state_->StatusOf(*job);
    if (status.state != JobState::kDone) widening = job->widening;
  }
  ImageBuilder image(status.spec, widening);
  const TileGrid grid{status.spec.crop, status.spec.tile};
  for (uint32_t tile = 0; tile < grid.Count(); ++tile) {
    EstimateInput input;
    std::vector<double> plain;
    {
      MutexLock lock(film->mutex);
      input = GatherEstimateInput(*film->film, grid.Rect(tile), status.spec.sampler);
      plain = GatherPlain(*film->film, grid.Rect(tile));
    }
    image.Fill(input, plain);
  }
  return image.Finish(ImageMetadata(status, state_->options.build));
}

}  // namespace strata
