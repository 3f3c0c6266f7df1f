#include "cli/follow.h"

#include <chrono>
#include <optional>
#include <thread>

#include "common/sync.h"

namespace strata {
namespace {

using Clock = std::chrono::steady_clock;

/// How soon an interrupt is noticed.
constexpr std::chrono::milliseconds kInterruptLatency{100};

/// Hands statuses from the thread that reads the stream to the one that shows them. A status that
/// was not taken in time is replaced by the next.
class Mailbox {
 public:
  /// False when nobody wants further statuses.
  bool Put(const JobStatus& status) STRATA_EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    status_ = status;
    changed_.NotifyAll();
    return wanted_;
  }
  /// The stream ended.
  void Close(absl::Status how) STRATA_EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    end_ = std::move(how);
    changed_.NotifyAll();
  }
  void Refuse() STRATA_EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    wanted_ = false;
  }

  struct Mail {
    std::optional<JobStatus> status;
    std::optional<absl::Status> end;  ///< Set once the stream ended and all statuses were taken.
  };
  /// Whatever is there by `deadline`.
  Mail Take(Clock::time_point deadline) STRATA_EXCLUDES(mutex_) {
    MutexLock lock(mutex_);
    while (!status_ && !end_ && changed_.WaitUntil(mutex_, deadline)) {
    }
    Mail mail;
    mail.status.swap(status_);
    if (!mail.status) mail.end = end_;
    return mail;
  }

 private:
  Mutex mutex_;
  CondVar changed_;
  std::optional<JobStatus> status_ STRATA_GUARDED_BY(mutex_);
  std::optional<absl::Status> end_ STRATA_GUARDED_BY(mutex_);
  bool wanted_ STRATA_GUARDED_BY(mutex_) = true;
};

/// One stream of statuses, read by a thread of its own so that an interrupt need not wait for one.
class StatusStream {
 public:
  StatusStream(FarmClient& client, const JobId& job)
      : reader_([this, &client, job] {
          mailbox_.Close(
              client.Watch(job, [this](const JobStatus& status) { return mailbox_.Put(status); }));
        }) {}
  ~StatusStream() { mailbox_.Refuse(); }
  Mailbox& mailbox() { return mailbox_; }

 private:
  Mailbox mailbox_;
  std::jthread reader_;
};

}  // namespace

absl::StatusOr<JobStatus> FollowJob(FarmClient& client, const JobId& job, ProgressDisplay& display,
                                    const InterruptWatch& interrupts,
                                    const std::function<bool()>& on_interrupt) {
  JobStatus last;
  last.id = job;
  bool interrupt_told = false;
  while (true) {
    StatusStream stream(client, job);
    std::optional<absl::Status> end;
    while (!end) {
      Mailbox::Mail mail = stream.mailbox().Take(Clock::now() + kInterruptLatency);
      if (mail.status) {
        last = *std::move(mail.status);
        display.Show(last, Clock::now());
        if (IsFinal(last.state)) return last;
      }
      end = std::move(mail.end);
      if (interrupts.interrupted() && !interrupt_told) {
        interrupt_told = true;
        if (!on_interrupt()) return last;
      }
    }
    if (!end->ok() && !absl::IsUnavailable(*end)) return *end;
    // Get waits for the server as long as any call does, so this is no busy loop.
    STRATA_ASSIGN_OR_RETURN(last, client.Get(job));
    if (IsFinal(last.state)) return last;
  }
}

}  // namespace strata
