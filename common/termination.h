#pragma once

#include <atomic>
#include <functional>
#include <thread>

namespace strata {

/// Keeps SIGINT and SIGTERM from ending the process. Call in main before any thread starts, as
/// threads inherit it.
void BlockTerminationSignals();

/// Hears the blocked signals on a thread of its own, where anything may be called.
class TerminationSignals {
 public:
  /// `on_signal` gets how many came so far, from 1.
  explicit TerminationSignals(std::function<void(int count)> on_signal);
  ~TerminationSignals();

 private:
  std::atomic<bool> stopping_ = false;
  std::thread thread_;
};

}  // namespace strata
