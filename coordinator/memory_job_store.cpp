#include <fmt/format.h>

#include <deque>
#include <fstream>
#include <map>
#include <system_error>
#include <utility>

#include "coordinator/job_store.h"

namespace strata {
namespace {

class MemoryJobStore final : public JobStore {
 public:
  explicit MemoryJobStore(std::filesystem::path last_job_file)
      : last_job_file_(std::move(last_job_file)) {
    std::ifstream(last_job_file_) >> last_job_;
  }

  absl::StatusOr<std::vector<StoredJob>> Jobs() const override {
    std::vector<StoredJob> jobs;
    for (const auto& [number, entry] : jobs_) jobs.push_back(entry.job);
    return jobs;
  }

  absl::StatusOr<std::optional<JobId>> FindRequest(std::string_view request_id) const override {
    for (const auto& [number, entry] : jobs_) {
      if (entry.job.request_id == request_id) return entry.job.id;
    }
    return std::nullopt;
  }

  absl::StatusOr<JobId> AddJob(const JobSpec& spec, std::string_view request_id,
                               double submitted_unix_s) override {
    STRATA_RETURN_IF_ERROR(SaveLastJob(last_job_ + 1));
    const uint64_t number = ++last_job_;
    const JobId id = fmt::format("j-{}", number);
    jobs_[number].job = {
        id, spec, JobState::kQueued, "", std::string(request_id), submitted_unix_s};
    numbers_[id] = number;
    return id;
  }

  absl::Status SetState(const JobId& job, JobState state, std::string_view message) override {
    return Change(job, [&](Entry& entry) {
      entry.job.state = state;
      entry.job.message = message;
    });
  }

  absl::Status SetPriority(const JobId& job, int priority) override {
    return Change(job, [&](Entry& entry) { entry.job.spec.priority = priority; });
  }

  absl::Status DeleteJob(const JobId& job) override {
    const auto number = numbers_.find(job);
    if (number == numbers_.end()) return Unknown(job);
    jobs_.erase(number->second);
    numbers_.erase(number);
    return absl::OkStatus();
  }

  absl::Status SaveRound(const JobId& job, uint32_t round, std::string_view plan) override {
    Entry* entry = Find(job);
    if (entry == nullptr) return Unknown(job);
    if (round != entry->rounds.size()) {
      return absl::FailedPreconditionError(
          fmt::format("job {}: round {} was saved or comes later", job, round));
    }
    entry->rounds.emplace_back(plan);
    return absl::OkStatus();
  }

  absl::StatusOr<std::vector<std::string>> Rounds(const JobId& job) const override {
    const Entry* entry = Find(job);
    if (entry == nullptr) return Unknown(job);
    return entry->rounds;
  }

  absl::Status AppendLog(const JobId& job, const LogLine& line) override {
    return Change(job, [&](Entry& entry) {
      entry.log.push_back(line);
      if (entry.log.size() > kMaxLogLines) entry.log.pop_front();
    });
  }

  absl::StatusOr<std::vector<LogLine>> Log(const JobId& job) const override {
    const Entry* entry = Find(job);
    if (entry == nullptr) return Unknown(job);
    return std::vector<LogLine>(entry->log.begin(), entry->log.end());
  }

 private:
  struct Entry {
    StoredJob job;
    std::vector<std::string> rounds;
    std::deque<LogLine> log;
  };

  static absl::Status Unknown(const JobId& job) {
    return absl::NotFoundError(fmt::format("job {} does not exist", job));
  }

  Entry* Find(const JobId& job) {
    const auto number = numbers_.find(job);
    return number == numbers_.end() ? nullptr : &jobs_.at(number->second);
  }
  const Entry* Find(const JobId& job) const {
    const auto number = numbers_.find(job);
    return number == numbers_.end() ? nullptr : &jobs_.at(number->second);
  }

  template <typename Edit>
  absl::Status Change(const JobId& job, Edit edit) {
    Entry* entry = Find(job);
    if (entry == nullptr) return Unknown(job);
    edit(*entry);
    return absl::OkStatus();
  }

  absl::Status SaveLastJob(uint64_t number) const {
    if (last_job_file_.empty()) return absl::OkStatus();
    const std::filesystem::path temporary = last_job_file_.string() + ".new";
    std::ofstream file(temporary, std::ios::trunc);
    file << number << '\n';
    file.close();
    std::error_code error;
    if (file) std::filesystem::rename(temporary, last_job_file_, error);
    if (file && !error) return absl::OkStatus();
    return absl::UnavailableError(fmt::format("{}: cannot be written", last_job_file_.string()));
  }

  std::filesystem::path last_job_file_;
  uint64_t last_job_ = 0;
  std::map<uint64_t, Entry> jobs_;  ///< By number, so in the order of submission.
  std::map<JobId, uint64_t> numbers_;
};

}  // namespace

std::unique_ptr<JobStore> NewMemoryJobStore(std::filesystem::path last_job_file) {
  return std::make_unique<MemoryJobStore>(std::move(last_job_file));
}

}  // namespace strata
