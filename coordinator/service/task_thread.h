#pragma once

#include <deque>
#include <functional>
#include <thread>

#include "common/sync.h"

namespace strata {

/// One thread for requests that take long (a 4K image), so that gRPC's callback threads stay free.
/// Tasks run in the order they came; one at a time, which also bounds their memory.
class TaskThread {
 public:
  TaskThread() : thread_([this] { Run(); }) {}
  /// Runs what was posted, then ends.
  ~TaskThread();

  void Post(std::function<void()> task);

 private:
  void Run();

  Mutex mutex_;
  CondVar changed_;
  std::deque<std::function<void()>> tasks_ STRATA_GUARDED_BY(mutex_);
  bool stopping_ STRATA_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace strata
