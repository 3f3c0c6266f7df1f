#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "common/sync.h"

namespace strata {

/// The first sample of a pixel that was NaN or infinite.
struct Defect {
  int64_t pixel = 0;  ///< Row-major in the unit.
  uint32_t replicate = 0, sample = 0;
};

/// Defects of a unit, found by all threads.
class DefectList {
 public:
  void Add(const Defect& defect) {
    MutexLock lock(mutex_);
    defects_.push_back(defect);
  }
  /// In the order of pixels, whichever thread came first. For when all threads are done.
  std::vector<Defect> Sorted() {
    MutexLock lock(mutex_);
    std::sort(defects_.begin(), defects_.end(),
              [](const Defect& a, const Defect& b) { return a.pixel < b.pixel; });
    return defects_;
  }

 private:
  Mutex mutex_;
  std::vector<Defect> defects_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
