#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "common/sync.h"
#include "worker/integrator/render.h"

namespace strata {

/// The calling thread and `threads` - 1 others, which sleep between calls of Run.
struct RenderPool::State {
 public:
  explicit State(int threads);
  ~State();

  /// Calls work(block) once for each block in [0, blocks), from all threads, in any order; returns
  /// when all are done. One call at a time.
  void Run(int64_t blocks, const std::function<void(int64_t)>& work);

  int threads() const { return static_cast<int>(helpers_.size()) + 1; }

 private:
  void HelperLoop();
  void TakeBlocks(int64_t blocks, const std::function<void(int64_t)>& work);

  Mutex mutex_;
  CondVar changed_;
  const std::function<void(int64_t)>* work_ STRATA_GUARDED_BY(mutex_) = nullptr;
  int64_t blocks_ STRATA_GUARDED_BY(mutex_) = 0;
  uint64_t call_ STRATA_GUARDED_BY(mutex_) = 0;  ///< Grows with every Run.
  int busy_ STRATA_GUARDED_BY(mutex_) = 0;       ///< Helpers that have not finished this call.
  bool stop_ STRATA_GUARDED_BY(mutex_) = false;
  std::atomic<int64_t> next_block_ = 0;
  std::vector<std::thread> helpers_;
};

}  // namespace strata
