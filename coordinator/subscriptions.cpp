#include "coordinator/subscriptions.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace strata {

uint64_t Subscriptions::Add(const JobId& job, Callback on_change) {
  auto subscriber = std::make_shared<Subscriber>();
  subscriber->job = job;
  subscriber->on_change = std::move(on_change);
  MutexLock lock(mutex_);
  subscribers_[++last_handle_] = std::move(subscriber);
  return last_handle_;
}

void Subscriptions::Remove(uint64_t handle) {
  MutexLock lock(mutex_);
  const auto entry = subscribers_.find(handle);
  if (entry == subscribers_.end()) return;
  entry->second->ended = true;
  subscribers_.erase(entry);
}

bool Subscriptions::Any(const JobId& job) const {
  MutexLock lock(mutex_);
  return std::any_of(subscribers_.begin(), subscribers_.end(), [&](const auto& entry) {
    return entry.second->job == job && !entry.second->ended;
  });
}

void Subscriptions::Deliver(const JobId& job, const StatusSource& status) {
  std::vector<std::shared_ptr<Subscriber>> due;
  {
    MutexLock lock(mutex_);
    for (const auto& [handle, subscriber] : subscribers_) {
      if (subscriber->job != job || subscriber->ended) continue;
      if (subscriber->calling) {
        subscriber->again = true;
        continue;
      }
      subscriber->calling = true;
      due.push_back(subscriber);
    }
  }
  for (const auto& subscriber : due) DeliverTo(subscriber, status);
}

void Subscriptions::DeliverTo(const std::shared_ptr<Subscriber>& subscriber,
                              const StatusSource& status) {
  for (bool more = true; more;) {
    const std::optional<JobStatus> current = status();
    {
      MutexLock lock(mutex_);
      subscriber->again = false;
      if (subscriber->ended || !current) {
        subscriber->calling = false;
        return;
      }
    }
    subscriber->on_change(*current);
    MutexLock lock(mutex_);
    subscriber->ended |= IsFinal(current->state);
    more = subscriber->again && !subscriber->ended;
    subscriber->calling = more;
  }
}

}  // namespace strata
