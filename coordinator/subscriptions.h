#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>

#include "common/report.h"
#include "common/sync.h"

namespace strata {

/// Who wants to hear of which job. Thread-safe. Callbacks run without any lock held, one at a time
/// for each subscriber, and never after one with a final state.
class Subscriptions {
 public:
  using Callback = std::function<void(const JobStatus&)>;
  /// The job as it stands; nothing when it is no more.
  using StatusSource = std::function<std::optional<JobStatus>()>;

  uint64_t Add(const JobId& job, Callback on_change) STRATA_EXCLUDES(mutex_);
  void Remove(uint64_t handle) STRATA_EXCLUDES(mutex_);
  bool Any(const JobId& job) const STRATA_EXCLUDES(mutex_);

  /// Calls the job's subscribers with what `status` returns, asked anew for each call so that no
  /// older status follows a newer one. Who is being called by another thread is called once more
  /// by that thread.
  void Deliver(const JobId& job, const StatusSource& status) STRATA_EXCLUDES(mutex_);

 private:
  struct Subscriber {
    JobId job;
    Callback on_change;
    bool calling = false, again = false, ended = false;
  };
  void DeliverTo(const std::shared_ptr<Subscriber>& subscriber, const StatusSource& status)
      STRATA_EXCLUDES(mutex_);

  mutable Mutex mutex_;
  uint64_t last_handle_ STRATA_GUARDED_BY(mutex_) = 0;
  std::map<uint64_t, std::shared_ptr<Subscriber>> subscribers_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
