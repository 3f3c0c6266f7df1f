#pragma once

#include <sys/resource.h>

#include <chrono>

namespace strata {

/// Seconds since it was made: of the clock on the wall, or of user CPU time of all the process's
/// threads, which other work on the machine disturbs less.
class Stopwatch {
 public:
  explicit Stopwatch(bool cpu) : cpu_(cpu), start_(Now()) {}
  double Seconds() const { return Now() - start_; }

 private:
  double Now() const {
    if (!cpu_) {
      return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
          .count();
    }
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_utime.tv_sec) +
           1e-6 * static_cast<double>(usage.ru_utime.tv_usec);
  }

  bool cpu_;
  double start_;
};

}  // namespace strata
