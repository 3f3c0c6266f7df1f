// Several jobs and workers at once: shares, priority, pause, resume, cancel, stragglers.

#include <gmock/gmock.h>

#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;

class SharingTest : public FarmTest {
 protected:
  /// Worker i renders one unit every (i + 1) ticks; all workers are heard all the time.
  void Run(int ticks) {
    for (int t = 0; t < ticks; ++t) {
      for (size_t i = 0; i < workers_.size(); ++i) {
        if (t % (static_cast<int>(i) + 1) == 0) {
          workers_[i].RenderAndSend(now_);
        } else {
          workers_[i].Send(Heartbeat{}, now_);
        }
      }
      Pass(kTick);
    }
  }
  uint64_t Samples(const JobId& job) const { return Status(job).samples; }
  /// Of two jobs over some ticks, the first one's share of the samples.
  double Share(const JobId& first, const JobId& second, int ticks) {
    const uint64_t a = Samples(first), b = Samples(second);
    Run(ticks);
    const double da = static_cast<double>(Samples(first) - a);
    const double db = static_cast<double>(Samples(second) - b);
    return da / (da + db);
  }
};

TEST_F(SharingTest, EqualJobsGetEqualShares) {
  const JobId a = Submit(Spec(32, 32, 8 * 32 * 40)), b = Submit(Spec(32, 32, 8 * 32 * 40));
  for (int i = 0; i < 3; ++i) Join();
  EXPECT_NEAR(Share(a, b, 150), 0.5, 0.05);
  EXPECT_NEAR(Share(a, b, 60), 0.5, 0.05);
}

TEST_F(SharingTest, JobsOfDifferentTilesGetEqualShares) {
  const JobId a = Submit(Spec(32, 32, 8 * 32 * 60, 8)), b = Submit(Spec(32, 32, 8 * 32 * 60, 16));
  for (int i = 0; i < 3; ++i) Join();
  EXPECT_NEAR(Share(a, b, 200), 0.5, 0.05);
}

TEST_F(SharingTest, AJobThatComesLaterSharesFromThenOn) {
  const JobId a = Submit(Spec(32, 32, 8 * 32 * 60));
  for (int i = 0; i < 3; ++i) Join();
  Run(100);
  const JobId b = Submit(Spec(32, 32, 8 * 32 * 60));
  Run(10);  // Leases that are out end first.
  EXPECT_NEAR(Share(a, b, 100), 0.5, 0.05);
}

TEST_F(SharingTest, HigherPriorityGoesFirst) {
  const JobId low = Submit(Spec(32, 32, 8 * 32 * 60));
  for (int i = 0; i < 3; ++i) Join();
  Run(20);
  JobSpec spec = Spec(32, 32, 8 * 32 * 10);
  spec.priority = 1;
  const JobId high = Submit(spec);
  Run(20);  // Leases that are out end first.
  const uint64_t before = Samples(low);
  Run(20);
  EXPECT_EQ(Samples(low), before);
  EXPECT_GT(Samples(high), 0u);
  Run(300);
  EXPECT_EQ(Status(high).state, JobState::kDone);
  EXPECT_GT(Samples(low), before) << "the rest of the farm's time is the other's";
}

TEST_F(SharingTest, PriorityCanBeChanged) {
  const JobId a = Submit(Spec(32, 32, 8 * 32 * 60)), b = Submit(Spec(32, 32, 8 * 32 * 60));
  Join();
  ASSERT_TRUE(farm_->SetPriority(b, 5, now_).ok());
  Run(10);
  EXPECT_LT(Share(a, b, 50), 0.01);
  EXPECT_EQ(farm_->SetPriority(b, 101, now_).code(), absl::StatusCode::kInvalidArgument);
}

TEST_F(SharingTest, APausedJobGetsNothingUntilItIsResumed) {
  const JobId a = Submit(Spec(32, 32, 8 * 32 * 40)), b = Submit(Spec(32, 32, 8 * 32 * 40));
  for (int i = 0; i < 3; ++i) Join();
  Run(30);
  ASSERT_TRUE(farm_->Pause(a, now_).ok());
  Run(30);  // What was leased is merged.
  const uint64_t paused_at = Samples(a);
  EXPECT_EQ(Share(a, b, 60), 0);
  EXPECT_EQ(Status(a).state, JobState::kPaused);
  ASSERT_TRUE(farm_->Resume(a, now_).ok());
  Run(10);
  EXPECT_NEAR(Share(a, b, 100), 0.5, 0.05) << "it does not catch up on what it missed";
  EXPECT_GT(Samples(a), paused_at);
  EXPECT_EQ(Status(a).state, JobState::kRunning);
}

TEST_F(SharingTest, ACancelledJobStopsAndCanBeRetriedToTheSameBits) {
  const JobSpec spec = Spec(32, 32, 8 * 32 * 10);
  const JobId whole = Submit(spec);
  Join();
  Join();
  RunAll();
  const JobId job = Submit(spec);
  Run(10);
  const std::optional<UnitResult> late = workers_[0].Render();
  ASSERT_TRUE(late.has_value());
  ASSERT_TRUE(farm_->Cancel(job, now_).ok());
  const uint64_t samples = Samples(job);
  workers_[0].Send(*late, now_);
  EXPECT_TRUE(workers_[0].todo().empty()) << "workers were told";
  Run(10);
  EXPECT_EQ(Samples(job), samples);
  EXPECT_EQ(Status(job).state, JobState::kCancelled);
  EXPECT_FALSE(farm_->Resume(job, now_).ok());
  ASSERT_TRUE(farm_->Retry(job, now_).ok());
  EXPECT_EQ(Samples(job), samples) << "what is merged stays";
  workers_[1].Send(*late, now_);
  RunAll();
  EXPECT_EQ(Status(job).state, JobState::kDone);
  EXPECT_EQ(Status(job).result, Status(whole).result);
  EXPECT_FALSE(farm_->Retry(job, now_).ok());
}

TEST_F(SharingTest, StragglersAreDuplicatedForIdleWorkers) {
  const JobId job = Submit(Spec(64, 16, 256));
  FakeWorker& slow = Join("slow");
  const std::optional<UnitResult> straggler = slow.Render();
  FakeWorker& fast = Join("fast");
  while (fast.RenderAndSend(now_)) {
  }
  EXPECT_LT(Status(job).fraction, 1);
  for (int i = 0; i < 20; ++i) {
    slow.Send(Heartbeat{}, now_);
    Pass(kTick);
    fast.RenderAndSend(now_);
  }
  EXPECT_EQ(Status(job).state, JobState::kDone) << "without a word from the slow one";
  EXPECT_GE(slow.leases_cancelled() + static_cast<int>(slow.todo().empty()), 1);
  const Digest result = Status(job).result;
  slow.Send(*straggler, now_);
  EXPECT_EQ(Status(job).result, result);
  EXPECT_EQ(Status(job).samples, 64u * 16 * 256);
}

TEST_F(SharingTest, AStuckFrontHoldsItsTileBack) {
  // One tile of 64 pieces; the first piece is never finished.
  Submit(Spec(8, 8, 8 * 32 * 64));
  FakeWorker& stuck = Join("stuck");
  EXPECT_EQ(stuck.todo().front().second.id.piece, 0u);
  stuck.Render();
  FakeWorker& other = Join("other");
  uint32_t furthest = 0;
  for (int i = 0; i < 500 && !other.todo().empty(); ++i) {
    if (other.todo().front().second.id.piece == 0) break;  // The straggler's duplicate.
    furthest = std::max(furthest, other.todo().front().second.id.piece);
    other.RenderAndSend(now_);
  }
  EXPECT_GT(furthest, 0u);
  EXPECT_LT(furthest, 32u) << "the window of one tile and two workers";
}

TEST_F(SharingTest, LeasesGrowToAboutASecond) {
  Submit(Spec(128, 128, 8 * 32 * 8));
  FakeWorker& worker = Join();
  for (int i = 0; i < 40; ++i) {
    worker.RenderAndSend(now_);
    Pass(kTick);
  }
  // One unit takes a tick of 0.1 s.
  EXPECT_GE(worker.todo().front().first.units.size(), 8u);
  EXPECT_LE(worker.todo().front().first.units.size(), 11u);
}

TEST_F(SharingTest, AWorkerHoldsTwoLeases) {
  Submit(Spec(32, 32, 256));
  FakeWorker& worker = Join();
  EXPECT_EQ(worker.leases_granted(), 2);
  worker.RenderAndSend(now_);
  EXPECT_EQ(worker.leases_granted(), 3);
}

TEST_F(SharingTest, ADrainingWorkerFinishesWhatItHolds) {
  const JobId job = Submit(Spec(32, 32, 256));
  FakeWorker& worker = Join();
  ASSERT_TRUE(farm_->Drain(worker.id()).ok());
  EXPECT_EQ(worker.drains(), 1);
  while (worker.RenderAndSend(now_)) {
  }
  EXPECT_EQ(worker.leases_granted(), 2);
  EXPECT_EQ(farm_->Workers(now_)[0].state, "draining");
  worker.Vanish(now_);
  FakeWorker& next = Join();
  next.Send(Draining{}, now_);
  EXPECT_EQ(next.leases_granted(), 2) << "no more than it had before it said so";
  RunAll();
  EXPECT_THAT(Status(job).message, HasSubstr("waits for a worker"));
}

}  // namespace
}  // namespace strata
