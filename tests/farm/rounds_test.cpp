// Jobs of several rounds: allocation after a pilot, targets, deadlines.

#include <gmock/gmock.h>

#include <thread>

#include "coordinator/next_round.h"
#include "coordinator/round_plan_format.h"
#include "tests/farm/farm_fixture.h"

namespace strata {
namespace {

using ::testing::HasSubstr;

JobSpec RingSpec(JobSpec spec) {
  spec.allocation = AllocationKind::kRing;
  return spec;
}

JobSpec TargetSpec(JobSpec spec, TargetKind target, double value) {
  spec.allocation = AllocationKind::kRing;
  spec.target = target;
  spec.target_value = value;
  return spec;
}

TEST_F(FarmTest, RingAllocationHasAPilotAndOneRoundMore) {
  const JobId job = Submit(RingSpec(Spec(48, 40, 256)));
  FakeWorker& worker = Join();
  while (Status(job).rounds == 0 && worker.RenderAndSend(now_)) Pass(kTick);
  EXPECT_EQ(Status(job).samples, 48u * 40 * 64);
  EXPECT_THAT(LogText(job), HasSubstr("round 1: "));
  EXPECT_NEAR(Status(job).fraction, 0.25, 0.05);
  RunAll();
  const JobStatus status = Status(job);
  EXPECT_EQ(status.state, JobState::kDone);
  EXPECT_EQ(status.rounds, 2u);
  EXPECT_TRUE(status.target_met);
  EXPECT_EQ(status.fraction, 1);
  // The budget is spent but for the noise of the pilot.
  EXPECT_NEAR(status.spp_mean, 256, 0.05 * 256);
}

TEST_F(FarmTest, SmallFramesAndBudgetsHaveOneRound) {
  for (const JobSpec& spec : {Spec(31, 64, 256), Spec(64, 64, 32)}) {
    const JobId job = Submit(RingSpec(spec));
    if (workers_.empty()) Join();
    RunAll();
    EXPECT_EQ(Status(job).rounds, 1u);
    EXPECT_EQ(Status(job).spp_mean, spec.spp);
  }
}

TEST_F(AnyWorkers, GiveTheSameDigestOfSeveralRounds) {
  const JobSpec frame = Spec(40, 34, 512, 16);
  for (JobSpec spec : {RingSpec(frame), TargetSpec(frame, TargetKind::kRelativeError, 0.04)}) {
    const Digest expected = DigestWith(spec, 1, 1);
    EXPECT_GE(farm_->List().back().rounds, 2u);
    for (const size_t workers : {2, 5}) EXPECT_EQ(DigestWith(spec, workers, workers), expected);
    spec.tile = 32;
    EXPECT_EQ(DigestWith(spec, 3, 77), expected);
    spec.seed = 1;
    EXPECT_NE(DigestWith(spec, 1, 1), expected);
  }
}

/// Jobs that are interrupted where one round ends and the next begins.
class BetweenRoundsTest : public FarmTest {
 protected:
  /// A job whose pilot is merged.
  JobId SubmitWithPilot(const JobSpec& spec, FakeWorker& worker) {
    const JobId job = Submit(spec);
    while (Status(job).rounds == 0 && worker.RenderAndSend(now_)) Pass(kTick);
    EXPECT_EQ(Status(job).rounds, 1u);
    return job;
  }
  /// The job ends as one that went through, from the same plans, each of which was made once: the
  /// store takes no second one for a round.
  void ExpectSame(const JobId& job, const JobId& whole) {
    EXPECT_EQ(Status(job).state, JobState::kDone) << LogText(job);
    EXPECT_EQ(Status(job).result, Status(whole).result);
    EXPECT_EQ(store_->Rounds(job).value(), store_->Rounds(whole).value());
  }
};

TEST_F(BetweenRoundsTest, AJobGoesOnWithThePlanThatWasSaved) {
  const JobSpec frame = Spec(40, 40, 256);
  for (const JobSpec& spec :
       {RingSpec(frame), TargetSpec(Spec(40, 40, 8192), TargetKind::kRelativeError, 0.04)}) {
    if (workers_.empty()) Join();
    FakeWorker& worker = workers_.front();
    const JobId whole = Submit(spec);
    RunAll();

    const JobId cancelled = SubmitWithPilot(spec, worker);
    ASSERT_TRUE(farm_->Cancel(cancelled, now_).ok());
    Pass(kTick);
    EXPECT_EQ(Status(cancelled).state, JobState::kCancelled);
    const std::vector<std::string> saved = store_->Rounds(cancelled).value();
    ASSERT_EQ(saved.size(), 2u);
    ASSERT_TRUE(farm_->Retry(cancelled, now_).ok());
    const auto plan = DecodeRoundPlan(saved[1]);
    ASSERT_TRUE(plan.ok());
    ASSERT_FALSE(worker.todo().empty());
    for (const auto& [lease, unit] : worker.todo()) EXPECT_EQ(plan->Unit(unit.id), unit);
    RunAll();
    ExpectSame(cancelled, whole);

    const JobId paused = SubmitWithPilot(spec, worker);
    ASSERT_TRUE(farm_->Pause(paused, now_).ok());
    Pass(std::chrono::seconds(1));
    ASSERT_TRUE(farm_->Resume(paused, now_).ok());
    RunAll();
    ExpectSame(paused, whole);
  }
}

TEST_F(BetweenRoundsTest, AJobCancelledWhileARoundIsPlannedGoesOnWithIt) {
  const JobSpec spec = RingSpec(Spec(128, 128, 128, 32));
  FakeWorker& worker = Join();
  const JobId whole = Submit(spec);
  RunAll();
  bool while_planned = false;
  for (int attempt = 0; attempt < 50 && !while_planned; ++attempt) {
    const JobId job = Submit(spec);
    std::optional<UnitResult> last;
    while (std::optional<UnitResult> next = worker.Render()) {
      if (last) worker.Send(*std::move(last), now_);
      last = std::move(next);
    }
    ASSERT_TRUE(last);
    const uint64_t pilot = 128 * 128 * 32;
    std::thread finish([&] { worker.Send(*std::move(last), now_); });
    while (Status(job).samples < pilot) std::this_thread::yield();
    ASSERT_TRUE(farm_->Cancel(job, now_).ok());
    finish.join();
    EXPECT_EQ(Status(job).state, JobState::kCancelled);
    EXPECT_TRUE(worker.todo().empty());
    const std::string log = LogText(job);
    while_planned = log.find("cancelled") < log.find("round 1: ");
    EXPECT_EQ(store_->Rounds(job).value().size(), 2u) << "it is saved in either case";
    ASSERT_TRUE(farm_->Retry(job, now_).ok());
    RunAll();
    ExpectSame(job, whole);
  }
  EXPECT_TRUE(while_planned) << "it was never cancelled in time";
}

TEST_F(FarmTest, TheTimeATargetTakesIsUnknownBeforeItsPilot) {
  const JobId job = Submit(TargetSpec(Spec(40, 40, 8192), TargetKind::kRelativeError, 0.04));
  FakeWorker& worker = Join();
  JobStatus status = Status(job);
  for (; status.rounds == 0; status = Status(job)) {
    EXPECT_LT(status.eta_s, 0);
    EXPECT_LT(status.eta_low_s, 0);
    EXPECT_LT(status.eta_high_s, 0);
    EXPECT_LT(status.samples_left, 0);
    ASSERT_TRUE(worker.RenderAndSend(now_));
    Pass(std::chrono::seconds(1));
  }
  EXPECT_GT(status.samples_left, 0);
  EXPECT_GT(status.eta_s, 0);
  EXPECT_GT(status.eta_high_s, status.eta_low_s);
  EXPECT_GT(status.eta_low_s, 0);
}

TEST_F(FarmTest, GreedyAllocationSaysThatItIsBiased) {
  JobSpec spec = Spec(40, 40, 256);
  EXPECT_EQ(LogText(Submit(spec)).find("biased"), std::string::npos);
  spec.allocation = AllocationKind::kGreedy;
  EXPECT_THAT(LogText(Submit(spec)), HasSubstr("warning: allocation greedy is biased"));
}

TEST_F(FarmTest, AnErrorTargetIsMetWithLittleMoreThanItTakes) {
  // The fake picture's channels are mean (0.5 + u): standard deviation 0.289 of the mean, so that
  // 4 % half-width relative to the luminance takes about (2 * 0.289 / 0.04)^2 (blue over
  // luminance)^2.
  const JobId job = Submit(TargetSpec(Spec(40, 40, 8192), TargetKind::kRelativeError, 0.04));
  Join();
  RunAll();
  const JobStatus status = Status(job);
  EXPECT_EQ(status.state, JobState::kDone);
  EXPECT_TRUE(status.target_met);
  EXPECT_GE(status.target_share, 0.99);
  EXPECT_GE(status.rounds, 2u);
  EXPECT_LT(status.rel_error, 0.04 * 1.25);
  EXPECT_LT(status.spp_mean, 1000);
}

TEST_F(FarmTest, ATargetOutOfReachEndsAtTheCapUnmet) {
  for (const TargetKind target : {TargetKind::kRelativeError, TargetKind::kRmse}) {
    const JobId job = Submit(TargetSpec(Spec(40, 40, 128), target, 1e-4));
    if (workers_.empty()) Join();
    RunAll();
    EXPECT_EQ(Status(job).state, JobState::kDone);
    EXPECT_FALSE(Status(job).target_met);
    EXPECT_EQ(Status(job).spp_mean, 128);
  }
}

TEST_F(FarmTest, UniformAllocationMeetsTargetsTooWithTheSameCountEverywhere) {
  for (const auto& [target, value] :
       {std::pair{TargetKind::kRelativeError, 0.05}, {TargetKind::kRmse, 0.005}}) {
    JobSpec spec = TargetSpec(Spec(24, 16, 1 << 16), target, value);
    spec.allocation = AllocationKind::kUniform;
    const JobId job = Submit(spec);
    if (workers_.empty()) Join();
    RunAll();
    const JobStatus status = Status(job);
    EXPECT_TRUE(status.target_met);
    EXPECT_EQ(status.samples % (24 * 16 * 8), 0u);
    EXPECT_LT(status.spp_mean, 1 << 16);
  }
}

TEST_F(FarmTest, TargetsThatMakeNoSenseAreRefused) {
  const auto refusal = [&](const JobSpec& spec) {
    const auto job = farm_->Submit(spec, "", now_);
    EXPECT_EQ(job.status().code(), absl::StatusCode::kInvalidArgument);
    return std::string(job.status().message());
  };
  EXPECT_THAT(refusal(TargetSpec(Spec(40, 40, 64), TargetKind::kTime, 0)),
              HasSubstr("target_value"));
  EXPECT_THAT(refusal(TargetSpec(Spec(7, 40, 64), TargetKind::kRmse, 1)), HasSubstr("crop"));
  JobSpec greedy = TargetSpec(Spec(40, 40, 64), TargetKind::kRmse, 1);
  greedy.allocation = AllocationKind::kGreedy;
  EXPECT_THAT(refusal(greedy), HasSubstr("greedy is biased"));
}

/// Jobs that a deadline ends.
class DeadlineTest : public FarmTest {
 protected:
  /// A job whose units take a tick each.
  JobId SubmitFor(double seconds, uint32_t cap = 1 << 16) {
    return Submit(TargetSpec(Spec(32, 32, cap, 32), TargetKind::kTime, seconds));
  }
};

TEST_F(DeadlineTest, RoundsFillTheTime) {
  const JobId job = SubmitFor(20);
  Join();
  RunAll();
  Pass(std::chrono::seconds(30));
  const JobStatus status = Status(job);
  EXPECT_EQ(status.state, JobState::kDone) << LogText(job);
  EXPECT_TRUE(status.target_met);
  EXPECT_GT(status.rounds, 2u);
  EXPECT_LT(status.wall_s, 21);
  EXPECT_GT(status.wall_s, 14);
}

TEST_F(DeadlineTest, AnUnfinishedRoundIsDroppedWhole) {
  const JobId job = SubmitFor(20);
  FakeWorker& worker = Join();
  while (Status(job).rounds < 3 && worker.RenderAndSend(now_)) Pass(kTick);
  const JobStatus before = Status(job);
  ASSERT_EQ(before.rounds, 3u);
  // A part of the next round is merged, then all stands still.
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(worker.RenderAndSend(now_));
  ASSERT_GT(Status(job).samples, before.samples);
  std::optional<UnitResult> late = worker.Render();
  Pass(std::chrono::seconds(21));
  const JobStatus status = Status(job);
  EXPECT_EQ(status.state, JobState::kDone);
  EXPECT_EQ(status.samples, before.samples);
  EXPECT_EQ(status.rounds, 3u);
  EXPECT_THAT(status.message, HasSubstr("dropped"));
  const Digest result = status.result;
  ASSERT_TRUE(late);
  worker.Send(*late, now_);
  Pass(kTick);
  EXPECT_EQ(Status(job).result, result);
  EXPECT_EQ(Status(job).samples, before.samples);

  // The same rounds as the whole of a job: the picture is that of the rounds that are told.
  EXPECT_EQ(SamplesInImage(job), before.samples);
}

TEST_F(DeadlineTest, TheFirstRoundIsNeverDropped) {
  const JobId job = SubmitFor(0.05);
  FakeWorker& worker = Join();
  Pass(std::chrono::seconds(2));
  EXPECT_EQ(Status(job).state, JobState::kRunning);
  EXPECT_TRUE(worker.RenderAndSend(now_));
  RunAll();
  EXPECT_EQ(Status(job).state, JobState::kDone);
  EXPECT_EQ(Status(job).spp_mean, 8);
}

TEST_F(DeadlineTest, TheCapEndsAJobBeforeItsTime) {
  const JobId job = SubmitFor(1000, 64);
  Join();
  RunAll();
  EXPECT_EQ(Status(job).state, JobState::kDone);
  EXPECT_LE(Status(job).spp_mean, 64 * 1.2);
}

TEST_F(FarmTest, TheErrorShownOfAJobInProgressHoldsAtAllTimes) {
  const JobId job = Submit(Spec(16, 16, 2048));
  FakeWorker& worker = Join();
  while (Status(job).fraction < 0.9 && worker.RenderAndSend(now_)) Pass(kTick);
  Pass(std::chrono::seconds(1));
  const double watched = Status(job).rel_error;
  RunAll();
  // Wider by 1.5 and more, where nine tenths of the samples make five per cent.
  EXPECT_GT(watched, 1.3 * Status(job).rel_error);
  EXPECT_LT(watched, 2.0 * Status(job).rel_error);
}

}  // namespace
}  // namespace strata
