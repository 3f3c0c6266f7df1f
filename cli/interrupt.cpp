#include "cli/interrupt.h"

#include <unistd.h>

#include <atomic>

#include "cli/exit_status.h"

namespace strata {
namespace {

// A signal handler can reach nothing but what lives for the whole process.
std::atomic<bool> signalled{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void OnSignal(int) {
  if (signalled.exchange(true)) _exit(static_cast<int>(ExitStatus::kInterrupted));
}

}  // namespace

InterruptWatch::InterruptWatch() {
  signalled = false;
  struct sigaction action {};
  action.sa_handler = OnSignal;
  action.sa_flags = SA_RESTART;
  sigaction(SIGINT, &action, &old_interrupt_);
  sigaction(SIGTERM, &action, &old_terminate_);
}

InterruptWatch::~InterruptWatch() {
  sigaction(SIGINT, &old_interrupt_, nullptr);
  sigaction(SIGTERM, &old_terminate_, nullptr);
}

bool InterruptWatch::interrupted() const { return signalled; }

}  // namespace strata
