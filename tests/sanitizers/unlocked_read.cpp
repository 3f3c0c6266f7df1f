// The control of clang's thread-safety analysis: a field is read without its lock, so this source
// must not compile (tests/CMakeLists.txt).

#include "common/sync.h"

namespace strata {

struct Counter {
  Mutex mutex;
  int count STRATA_GUARDED_BY(mutex) = 0;
};

int Read(const Counter& counter) { return counter.count; }

}  // namespace strata
