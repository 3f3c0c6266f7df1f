#pragma once

#include <csignal>

namespace strata {

/// From now on SIGINT or SIGTERM ends the process at once with status 130, as fits work that leaves
/// nothing behind: reading a scene, waiting for a server.
void ExitOnInterrupt();

/// While one lives, the first SIGINT or SIGTERM is only noted, so that a command can end cleanly; a
/// second one ends the process at once with status 130. At most one at a time.
class InterruptWatch {
 public:
  InterruptWatch();
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

  bool interrupted() const;

 private:
  struct sigaction old_interrupt_ {};
  struct sigaction old_terminate_ {};
};

}  // namespace strata
