#include "common/termination.h"

#include <csignal>
#include <ctime>
#include <utility>

namespace strata {
namespace {

sigset_t TerminationSet() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  return set;
}

}  // namespace

void BlockTerminationSignals() {
  const sigset_t set = TerminationSet();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

TerminationSignals::TerminationSignals(std::function<void(int count)> on_signal)
    : thread_([this, on_signal = std::move(on_signal)] {
        const sigset_t set = TerminationSet();
        const timespec period{0, 100'000'000};
        int count = 0;
        while (!stopping_) {
          if (sigtimedwait(&set, nullptr, &period) > 0) on_signal(++count);
        }
      }) {}

TerminationSignals::~TerminationSignals() {
  stopping_ = true;
  thread_.join();
}

}  // namespace strata
