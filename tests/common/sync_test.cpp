// The lock keeps others out, and a wait ends by notification or by its deadline.

#include "common/sync.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace strata {
namespace {

TEST(SyncTest, OneThreadAtATime) {
  Mutex mutex;
  int count = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      for (int i = 0; i < 10000; ++i) {
        MutexLock lock(mutex);
        ++count;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(count, 40000);
}

TEST(SyncTest, AWaitEndsByNotification) {
  Mutex mutex;
  CondVar changed;
  bool ready = false, seen = false;
  std::thread waiter([&] {
    MutexLock lock(mutex);
    while (!ready) changed.Wait(mutex);
    seen = true;
  });
  {
    MutexLock lock(mutex);
    ready = true;
    changed.NotifyOne();
  }
  waiter.join();
  EXPECT_TRUE(seen);
}

TEST(SyncTest, AWaitEndsByItsDeadline) {
  Mutex mutex;
  CondVar changed;
  MutexLock lock(mutex);
  const auto passed = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  EXPECT_FALSE(changed.WaitUntil(mutex, passed));
}

}  // namespace
}  // namespace strata
