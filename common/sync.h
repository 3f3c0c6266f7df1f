#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>

// A small annotated wrapper over std::mutex, so that clang's thread-safety analysis sees which
// fields a lock guards. Abseil's Mutex would do, but its Debian build is not instrumented and
// confuses the thread sanitizer.

#if defined(__clang__)
#define STRATA_TSA(x) __attribute__((x))
#else
#define STRATA_TSA(x)
#endif

#define STRATA_GUARDED_BY(m) STRATA_TSA(guarded_by(m))
#define STRATA_REQUIRES(...) STRATA_TSA(requires_capability(__VA_ARGS__))
#define STRATA_EXCLUDES(...) STRATA_TSA(locks_excluded(__VA_ARGS__))

namespace strata {

class STRATA_TSA(capability("mutex")) Mutex {
 public:
  void Lock() STRATA_TSA(acquire_capability()) { mutex_.lock(); }
  void Unlock() STRATA_TSA(release_capability()) { mutex_.unlock(); }

 private:
  friend class CondVar;
  std::mutex mutex_;
};

/// Holds a Mutex for the length of a scope.
class STRATA_TSA(scoped_lockable) MutexLock {
 public:
  explicit MutexLock(Mutex& mutex) STRATA_TSA(acquire_capability(mutex)) : mutex_(mutex) {
    mutex_.Lock();
  }
  ~MutexLock() STRATA_TSA(release_capability()) { mutex_.Unlock(); }
  MutexLock(const MutexLock&) = delete;
  MutexLock& operator=(const MutexLock&) = delete;

 private:
  Mutex& mutex_;
};

/// A condition variable for Mutex. Waits may wake spuriously: callers loop on their condition.
class CondVar {
 public:
  void Wait(Mutex& mutex) STRATA_REQUIRES(mutex) {
    std::unique_lock<std::mutex> lock(mutex.mutex_, std::adopt_lock);
    condition_.wait(lock);
    lock.release();
  }

  /// False when `deadline` passed before a notification.
  template <class Clock, class Duration>
  bool WaitUntil(Mutex& mutex, std::chrono::time_point<Clock, Duration> deadline)
      STRATA_REQUIRES(mutex) {
    std::unique_lock<std::mutex> lock(mutex.mutex_, std::adopt_lock);
    const bool notified = condition_.wait_until(lock, deadline) == std::cv_status::no_timeout;
    lock.release();
    return notified;
  }

  void NotifyOne() { condition_.notify_one(); }
  void NotifyAll() { condition_.notify_all(); }

 private:
  std::condition_variable condition_;
};

}  // namespace strata
