#include "worker/integrator/render_pool.h"

namespace strata {

RenderPool::RenderPool(int threads) : state_(std::make_unique<State>(threads)) {}
RenderPool::~RenderPool() = default;
int RenderPool::threads() const { return state_->threads(); }

RenderPool::State::State(int threads) {
  for (int i = 1; i < threads; ++i) helpers_.emplace_back([this] { HelperLoop(); });
}

RenderPool::State::~State() {
  {
    MutexLock lock(mutex_);
    stop_ = true;
  }
  changed_.NotifyAll();
  for (std::thread& helper : helpers_) helper.join();
}

void RenderPool::State::Run(int64_t blocks, const std::function<void(int64_t)>& work) {
  {
    MutexLock lock(mutex_);
    work_ = &work;
    blocks_ = blocks;
    busy_ = static_cast<int>(helpers_.size());
    next_block_ = 0;
    ++call_;
  }
  changed_.NotifyAll();
  TakeBlocks(blocks, work);
  MutexLock lock(mutex_);
  while (busy_ > 0) changed_.Wait(mutex_);
}

void RenderPool::State::HelperLoop() {
  uint64_t done = 0;
  while (true) {
    const std::function<void(int64_t)>* work;
    int64_t blocks;
    {
      MutexLock lock(mutex_);
      while (!stop_ && call_ == done) changed_.Wait(mutex_);
      if (stop_) return;
      done = call_;
      work = work_;
      blocks = blocks_;
    }
    TakeBlocks(blocks, *work);
    MutexLock lock(mutex_);
    if (--busy_ == 0) changed_.NotifyAll();
  }
}

void RenderPool::State::TakeBlocks(int64_t blocks, const std::function<void(int64_t)>& work) {
  while (true) {
    const int64_t block = next_block_.fetch_add(1, std::memory_order_relaxed);
    if (block >= blocks) return;
    work(block);
  }
}

}  // namespace strata
