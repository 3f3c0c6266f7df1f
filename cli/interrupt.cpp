#include "cli/interrupt.h"

#include <unistd.h>

#include <atomic>

#include "cli/exit_status.h"

namespace strata {
namespace {

// A signal handler can reach nothing but what lives for the whole process.
std::atomic<bool> signalled{false};
static_assert(std::atomic<bool>::is_always_lock_free);

void Exit(int) { _exit(static_cast<int>(ExitStatus::kInterrupted)); }

void NoteOrExit(int signal) {
  if (signalled.exchange(true)) Exit(signal);
}

struct sigaction Handler(void (*handler)(int)) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = SA_RESTART;
  return action;
}

}  // namespace

void ExitOnInterrupt() {
  const struct sigaction action = Handler(Exit);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

InterruptWatch::InterruptWatch() {
  signalled = false;
  const struct sigaction action = Handler(NoteOrExit);
  sigaction(SIGINT, &action, &old_interrupt_);
  sigaction(SIGTERM, &action, &old_terminate_);
}

InterruptWatch::~InterruptWatch() {
  sigaction(SIGINT, &old_interrupt_, nullptr);
  sigaction(SIGTERM, &old_terminate_, nullptr);
}

bool InterruptWatch::interrupted() const { return signalled; }

}  // namespace strata
