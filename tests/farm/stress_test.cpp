// Many threads at once, for the thread sanitizer; the result must still be the same.

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

class StressTest : public FarmTest {
 protected:
  /// A worker's thread: renders until told to stop; some send every result twice.
  void Work(FakeWorker& worker, bool twice, const std::atomic<bool>& stop) {
    while (!stop) {
      if (std::optional<UnitResult> result = worker.Render()) {
        if (twice) worker.Send(*result, Now());
        worker.Send(*std::move(result), Now());
      } else {
        worker.Send(Heartbeat{}, Now());
        std::this_thread::yield();
      }
    }
  }
  /// Simulated time: a millisecond passes with every look at it.
  SteadyTime Now() { return now_ + std::chrono::milliseconds(++looks_); }

  std::atomic<int64_t> looks_{0};
};

TEST_F(StressTest, AJobCancelledWhileItsFiguresAreMadeCanBeRetried) {
  const JobId job = Submit(Spec(512, 512, 8, 64));
  FakeWorker& worker = Join();
  std::optional<UnitResult> last;
  while (std::optional<UnitResult> next = worker.Render()) {
    if (last) worker.Send(*std::move(last), now_);
    last = std::move(next);
  }
  std::thread finish([&] { worker.Send(*std::move(last), now_); });
  while (Status(job).fraction < 1) std::this_thread::yield();
  const bool cancelled = farm_->Cancel(job, now_).ok();  // Unless the figures were there already.
  finish.join();
  if (cancelled) {
    EXPECT_TRUE(farm_->Retry(job, now_).ok());
  }
  EXPECT_EQ(Status(job).state, JobState::kDone);
  EXPECT_NE(Status(job).result, Digest());
}

TEST_F(StressTest, AResultThatComesWhileItsRoundIsDroppedIsNotCounted) {
  JobSpec spec = Spec(64, 64, 1 << 16, 16);
  spec.target = TargetKind::kTime;
  spec.target_value = 20;
  FakeWorker& worker = Join();
  std::jthread looks_on([&](const std::stop_token& stop) {  // So that the lock is waited for.
    while (!stop.stop_requested()) farm_->List();
  });
  for (int attempt = 0; attempt < 40; ++attempt) {
    const JobId job = Submit(spec);
    while (Status(job).rounds < 2 && worker.RenderAndSend(now_)) {
      now_ += std::chrono::milliseconds(10);
      farm_->Tick(now_);
    }
    ASSERT_EQ(Status(job).rounds, 2u) << attempt << LogText(job) << farm_->Workers(now_)[0].state;
    std::optional<UnitResult> late = worker.Render();
    ASSERT_TRUE(late);
    now_ += std::chrono::seconds(21);
    std::thread send([&, now = now_] { worker.Send(*std::move(late), now); });
    farm_->Tick(now_);
    send.join();
    const JobStatus status = Status(job);
    EXPECT_EQ(status.state, JobState::kDone);
    EXPECT_EQ(status.samples, SamplesInImage(job));
    ASSERT_TRUE(farm_->Delete(job).ok());
  }
}

TEST_F(StressTest, ThreadsDoNotChangeTheResult) {
  const JobSpec spec = Spec(40, 40, 8 * 32 * 4, 8);
  const JobId quiet = Submit(spec);
  FakeWorker& alone = Join();
  while (alone.RenderAndSend(now_)) {
  }
  alone.Vanish(now_);
  ASSERT_EQ(Status(quiet).state, JobState::kDone);

  const std::vector<JobId> jobs = {Submit(spec), Submit(spec), Submit(spec)};
  std::atomic<int> final_calls{0};
  for (const JobId& job : jobs) {
    ASSERT_TRUE(
        farm_
            ->Subscribe(job, [&](const JobStatus& status) { final_calls += IsFinal(status.state); })
            .ok());
  }
  for (int i = 0; i < 4; ++i) Join();
  std::atomic<bool> stop{false};
  std::vector<std::thread> threads;
  for (size_t i = 1; i <= 4; ++i) {
    threads.emplace_back([&, i] { Work(workers_[i], i % 2 == 0, stop); });
  }
  threads.emplace_back([&] {
    while (!stop) {
      farm_->Tick(Now());
      farm_->List();
      farm_->Workers(Now());
      EXPECT_TRUE(farm_->Image(jobs[0]).ok());
      EXPECT_TRUE(farm_->Logs(jobs[1]).ok());
    }
  });
  EXPECT_TRUE(farm_->Pause(jobs[2], Now()).ok());
  EXPECT_TRUE(farm_->SetPriority(jobs[1], 3, Now()).ok());
  EXPECT_TRUE(farm_->Resume(jobs[2], Now()).ok());
  const auto all_done = [&] {
    return std::all_of(jobs.begin(), jobs.end(),
                       [&](const JobId& job) { return IsFinal(Status(job).state); });
  };
  while (!all_done() || final_calls < 3) std::this_thread::yield();
  stop = true;
  for (std::thread& thread : threads) thread.join();
  for (const JobId& job : jobs) {
    EXPECT_EQ(Status(job).state, JobState::kDone) << LogText(job);
    EXPECT_EQ(Status(job).result, Status(quiet).result);
  }
  EXPECT_EQ(final_calls, 3);
}

}  // namespace
}  // namespace strata
