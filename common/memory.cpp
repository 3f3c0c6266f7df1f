#include "common/memory.h"

#include <malloc.h>

namespace strata {

void KeepFreedMemory() {
  constexpr int kMegabyte = 1 << 20;
  mallopt(M_MMAP_THRESHOLD, 32 * kMegabyte);  // The most that glibc takes.
  mallopt(M_TRIM_THRESHOLD, 128 * kMegabyte);
}

}  // namespace strata
