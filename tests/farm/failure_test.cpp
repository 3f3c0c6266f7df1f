// Workers that vanish, fall silent, fail, send nonsense or differ.

#include <gmock/gmock.h>

#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

using std::chrono::seconds;
using ::testing::AllOf;
using ::testing::HasSubstr;

class FailureTest : public FarmTest {
 protected:
  /// The digest of the job rendered without trouble.
  Digest Expected(const JobSpec& spec) {
    const JobId job = Submit(spec);
    FakeWorker& worker = Join();
    while (worker.RenderAndSend(now_)) {
    }
    worker.Vanish(now_);
    return Status(job).result;
  }
  /// All workers but one are heard while time passes.
  void PassWithout(const FakeWorker& silent, std::chrono::milliseconds time) {
    for (auto t = std::chrono::milliseconds(0); t < time; t += kTick) {
      for (FakeWorker& worker : workers_) {
        if (&worker != &silent) worker.Send(Heartbeat{}, now_);
      }
      Pass(kTick);
    }
  }
};

TEST_F(FailureTest, ASilentWorkerLosesItsLeasesAndComesBackHarmlessly) {
  const JobSpec spec = Spec(32, 32, 512);
  const Digest expected = Expected(spec);
  const JobId job = Submit(spec);
  FakeWorker& stopped = Join("stopped");
  const UnitResult late = *stopped.Render();
  FakeWorker& other = Join("other");
  PassWithout(stopped, seconds(11));
  EXPECT_EQ(farm_->Workers(now_)[0].state, "lost");
  EXPECT_EQ(farm_->Workers(now_)[0].leases, 0);
  while (other.RenderAndSend(now_)) {
  }
  EXPECT_EQ(Status(job).state, JobState::kDone);
  EXPECT_EQ(Status(job).result, expected);
  stopped.Send(late, now_);
  stopped.Send(late, now_);
  EXPECT_EQ(Status(job).result, expected);
  EXPECT_EQ(Status(job).samples, 32u * 32 * 512);
  EXPECT_EQ(farm_->Workers(now_)[0].state, "idle");
  EXPECT_TRUE(stopped.todo().empty()) << "it was told to give its leases up";
}

TEST_F(FailureTest, ALateResultOfALostLeaseCountsWhileItIsStillWanted) {
  const JobSpec spec = Spec(32, 32, 512);
  const Digest expected = Expected(spec);
  const JobId job = Submit(spec);
  FakeWorker& stopped = Join("stopped");
  const UnitResult late = *stopped.Render();
  PassWithout(stopped, seconds(11));
  const uint64_t before = Status(job).samples;
  stopped.Send(late, now_);
  EXPECT_GT(Status(job).samples, before);
  RunAll();
  EXPECT_EQ(Status(job).result, expected);
}

TEST_F(FailureTest, AnyMessageRenewsALease) {
  Submit(Spec(32, 32, 512));
  FakeWorker& worker = Join();
  for (int i = 0; i < 10; ++i) {
    Pass(seconds(5));
    worker.Send(Heartbeat{}, now_);
  }
  EXPECT_EQ(farm_->Workers(now_)[0].leases, 2);
}

TEST_F(FailureTest, AStallOfTheCoordinatorIsForgiven) {
  Submit(Spec(32, 32, 512));
  Join();
  Pass(seconds(1));
  now_ += seconds(60);
  farm_->Tick(now_);
  EXPECT_EQ(farm_->Workers(now_)[0].leases, 2);
  Pass(seconds(11));
  EXPECT_EQ(farm_->Workers(now_)[0].leases, 0) << "but silence after it is not";
}

TEST_F(FailureTest, UnitsOfAVanishedWorkerAreLeasedSingly) {
  const JobSpec spec = Spec(64, 64, 512);
  const Digest expected = Expected(spec);
  const JobId job = Submit(spec);
  FakeWorker& first = Join();
  for (int i = 0; i < 20; ++i) {
    first.RenderAndSend(now_);
    Pass(kTick);
  }
  std::set<UnitId> held;
  for (const auto& [lease, unit] : first.todo()) held.insert(unit.id);
  ASSERT_GT(held.size(), 4u);
  first.Vanish(now_);
  FakeWorker& second = Join();
  size_t seen = 0;
  do {
    const auto& [lease, unit] = second.todo().front();
    if (!held.contains(unit.id)) continue;
    EXPECT_EQ(lease.units.size(), 1u);
    ++seen;
  } while (second.RenderAndSend(now_) && !second.todo().empty());
  EXPECT_EQ(seen, held.size());
  EXPECT_EQ(Status(job).result, expected);
}

TEST_F(FailureTest, AUnitThatFailsOnThreeWorkersFailsItsJob) {
  const JobId job = Submit(Spec(32, 32, 512));
  for (int i = 0; i < 4; ++i) Join();
  const UnitId poison = workers_[0].todo().front().second.id;
  const auto poisoned = [&](FakeWorker& worker) {
    return !worker.todo().empty() && worker.todo().front().second.id == poison;
  };
  std::set<std::string> failed_on;
  for (int i = 0; i < 200 && !IsFinal(Status(job).state); ++i) {
    for (FakeWorker& worker : workers_) {
      if (poisoned(worker)) {
        failed_on.insert(worker.id());
        worker.Fail("a light is NaN", "strata replay scene.pbrt --pixel 0,0", false, now_);
      } else {
        worker.RenderAndSend(now_);
      }
    }
    Pass(kTick);
  }
  EXPECT_EQ(Status(job).state, JobState::kFailed);
  EXPECT_EQ(failed_on.size(), 3u) << "three different workers";
  EXPECT_THAT(Status(job).message,
              AllOf(HasSubstr("a light is NaN"), HasSubstr("strata replay scene.pbrt")));
}

TEST_F(FailureTest, AUnitThatKillsThreeWorkersFailsItsJob) {
  const JobId job = Submit(Spec(32, 32, 512));
  const UnitId poison = Join().todo().front().second.id;
  for (int i = 0; i < 3; ++i) {
    FakeWorker& worker = workers_.back();
    while (worker.todo().front().second.id != poison) ASSERT_TRUE(worker.RenderAndSend(now_));
    EXPECT_FALSE(IsFinal(Status(job).state));
    worker.Vanish(now_);
    if (i < 2) Join();
  }
  EXPECT_EQ(Status(job).state, JobState::kFailed);
  EXPECT_THAT(Status(job).message, HasSubstr("vanished"));
  ASSERT_TRUE(farm_->Retry(job, now_).ok());
  Join();
  RunAll();
  EXPECT_EQ(Status(job).state, JobState::kDone) << "a retry forgets the failures";
}

TEST_F(FailureTest, AFailureThatPassesDoesNoHarm) {
  const JobSpec spec = Spec(32, 32, 512);
  const Digest expected = Expected(spec);
  const JobId job = Submit(spec);
  FakeWorker& only = Join();
  only.Fail("out of memory", "", false, now_);
  RunAll();
  EXPECT_EQ(Status(job).state, JobState::kDone);
  EXPECT_EQ(Status(job).result, expected);
  EXPECT_THAT(LogText(job), HasSubstr("out of memory"));
}

TEST_F(FailureTest, ASceneThatDoesNotLoadIsConfirmedByASecondWorker) {
  const JobId job = Submit(Spec(32, 32, 512));
  FakeWorker& first = Join();
  FakeWorker& second = Join();
  first.Fail("scene.pbrt:3: unknown shape", "", true, now_);
  EXPECT_EQ(Status(job).state, JobState::kRunning);
  EXPECT_TRUE(first.todo().empty() || farm_->Workers(now_)[0].leases == 0);
  second.Fail("scene.pbrt:3: unknown shape", "", true, now_);
  EXPECT_EQ(Status(job).state, JobState::kFailed);
  EXPECT_THAT(Status(job).message, HasSubstr("scene.pbrt:3: unknown shape"));
}

TEST_F(FailureTest, ASceneThatDoesNotLoadOnTheOnlyWorkerFailsAtOnce) {
  const JobId job = Submit(Spec(32, 32, 512));
  Join().Fail("scene.pbrt:3: unknown shape", "", true, now_);
  EXPECT_EQ(Status(job).state, JobState::kFailed);
}

TEST_F(FailureTest, NonsenseIsRefusedAndItsSenderSentAway) {
  const JobSpec spec = Spec(32, 32, 512);
  const Digest expected = Expected(spec);
  const JobId job = Submit(spec);
  FakeWorker& good = Join("good");
  FakeWorker& bad = Join("bad");
  for (int i = 0; i < 3; ++i) {
    UnitResult result = *bad.Render();
    result.partial.values[5] = std::nan("");
    bad.Send(result, now_);
  }
  EXPECT_EQ(bad.refusals().size(), 1u);
  EXPECT_TRUE(bad.link().closed());
  EXPECT_THAT(LogText(job), HasSubstr("not finite"));
  bad.Vanish(now_);
  while (good.RenderAndSend(now_)) {
  }
  EXPECT_EQ(Status(job).result, expected);
}

TEST_F(FailureTest, ResultsOfUnknownJobsAndUnitsAreIgnored) {
  const JobId job = Submit(Spec(32, 32, 64));
  FakeWorker& worker = Join();
  UnitResult result = *worker.Render();
  const UnitResult good = result;
  result.job = "j-999";
  worker.Send(result, now_);
  EXPECT_EQ(Status(job).samples, 0u);
  result.job = job;
  result.partial.unit.tile = 77;
  worker.Send(result, now_);
  EXPECT_EQ(Status(job).samples, 0u);
  worker.Send(good, now_);
  EXPECT_GT(Status(job).samples, 0u);
  farm_->Receive("w-999", good, now_);
  farm_->Disconnect("w-999", now_);
}

TEST_F(FailureTest, ReproducibleJobsTakeWorkersOfOneClassAlone) {
  const JobId job = Submit(Spec(32, 32, 512));
  FakeWorker& first = Join("first");
  EXPECT_EQ(first.leases_granted(), 2);
  Hello other = TestHello("other");
  other.traced = DigestOf("another traced scene");
  FakeWorker& different = Join(other);
  EXPECT_EQ(different.leases_granted(), 0);
  EXPECT_THAT(LogText(job), AllOf(HasSubstr("is not used"), HasSubstr("traced digest")));
  first.Vanish(now_);
  Pass(kTick);
  EXPECT_EQ(different.leases_granted(), 0);
  EXPECT_THAT(Status(job).message, HasSubstr("traced digest"));
  Join("third");
  RunAll();
  EXPECT_EQ(Status(job).state, JobState::kDone);
}

TEST_F(FailureTest, OtherJobsTakeAnyWorker) {
  JobSpec spec = Spec(32, 32, 512);
  spec.reproducible = false;
  Submit(spec);
  EXPECT_EQ(Join("first").leases_granted(), 2);
  Hello other = TestHello("other");
  other.libraries["embree"] = "4.0.0";
  EXPECT_EQ(Join(other).leases_granted(), 2);
}

TEST_F(FailureTest, AWorkerOfAnotherProtocolOrKernelIsRefusedWithASentence) {
  Hello newer = TestHello("newer");
  newer.protocol = kProtocol + 1;
  FakeWorker& refused = Join(newer);
  ASSERT_EQ(refused.refusals().size(), 1u);
  EXPECT_THAT(refused.refusals()[0].reason, HasSubstr("update the coordinator"));
  EXPECT_TRUE(refused.link().closed());
  Hello kernel = TestHello("kernel");
  kernel.kernel_revision = 2;
  EXPECT_THAT(Join(kernel).refusals().at(0).reason, HasSubstr("kernel revision 2"));
  EXPECT_TRUE(farm_->Workers(now_).empty());
}

}  // namespace
}  // namespace strata
