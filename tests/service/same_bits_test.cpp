#include <gtest/gtest.h>
#include <signal.h>

#include <algorithm>

#include "tests/service/farm_under_test.h"

namespace strata {
namespace {

/// The digest of `scene` on one worker with one thread and the default tile.
Digest Reference(const TestScene& scene) {
  InProcessFarm farm(1, 1);
  const absl::StatusOr<Digest> digest = RunJob(farm.client(), scene);
  EXPECT_TRUE(digest.ok()) << digest.status().message();
  return digest.value_or(Digest{});
}

/// In-process and over TCP.
void ExpectSameEverywhere(const TestScene& scene) {
  const Digest reference = Reference(scene);
  const struct {
    int workers;
    uint32_t threads;
    int tile;
  } farms[] = {{1, 4, 16}, {2, 1, 64}, {3, 4, 32}, {7, 1, 16}};
  for (const auto& [workers, threads, tile] : farms) {
    TestScene job = scene;
    job.spec.tile = tile;
    InProcessFarm local(workers, threads);
    const absl::StatusOr<Digest> digest = RunJob(local.client(), job);
    ASSERT_TRUE(digest.ok()) << digest.status().message();
    EXPECT_EQ(digest->Hex(), reference.Hex())
        << "in-process: " << workers << " x " << threads << ", tile " << tile;
  }
  for (const auto& [workers, threads, tile] : {farms[0], farms[1], farms[3]}) {
    TestScene job = scene;
    job.spec.tile = tile;
    TcpFarm farm;
    for (int i = 0; i < workers; ++i) farm.StartWorker(threads);
    ASSERT_TRUE(farm.AwaitWorkers(static_cast<size_t>(workers))) << farm.Logs();
    const absl::StatusOr<Digest> digest = RunJob(farm.client(), job);
    ASSERT_TRUE(digest.ok()) << digest.status().message() << farm.Logs();
    EXPECT_EQ(digest->Hex(), reference.Hex())
        << "TCP: " << workers << " x " << threads << ", tile " << tile;
  }
  TestScene other = scene;
  other.spec.seed = scene.spec.seed + 1;
  EXPECT_NE(Reference(other).Hex(), reference.Hex()) << "another seed must show";
}

class SameBits : public testing::TestWithParam<const char*> {};

TEST_P(SameBits, OnAnyFarm) {
  const std::optional<TestScene> scene = SharedScene(GetParam());
  if (!scene) GTEST_SKIP() << "the shared scene " << GetParam() << " is not there";
  ExpectSameEverywhere(*scene);
}

INSTANTIATE_TEST_SUITE_P(SharedScenes, SameBits,
                         testing::Values("cornell-box", "coffee", "staircase2"),
                         [](const auto& info) {
                           std::string name = info.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

/// A job that takes a few seconds of one thread, so that there is time to disturb it.
TestScene LongJob() {
  TestScene scene = OwnScene("cornell-box/cornell-box.pbrt");
  scene.spec.width = scene.spec.height = 96;
  scene.spec.crop = {0, 0, 96, 96};
  scene.spec.spp = 256;
  scene.spec.tile = 16;
  return scene;
}

bool AwaitFraction(FarmClient& client, const JobId& job, double fraction) {
  return Eventually([&] {
    const absl::StatusOr<JobStatus> status = client.Get(job);
    return status.ok() && (status->fraction >= fraction || IsFinal(status->state));
  });
}

TEST(SameBits, WithWorkersKilledAndJoinedWhileItRenders) {
  const TestScene scene = LongJob();
  const Digest reference = Reference(scene);
  TcpFarm farm;
  Process& first = farm.StartWorker(1);
  Process& second = farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(2)) << farm.Logs();
  const absl::StatusOr<JobId> job = SubmitJob(farm.client(), scene);
  ASSERT_TRUE(job.ok()) << job.status().message();
  ASSERT_TRUE(AwaitFraction(farm.client(), *job, 0.05));
  first.Signal(SIGKILL);
  farm.StartWorker(4);
  ASSERT_TRUE(AwaitFraction(farm.client(), *job, 0.4));
  second.Signal(SIGKILL);
  const absl::StatusOr<JobStatus> end = AwaitEnd(farm.client(), *job);
  ASSERT_TRUE(end.ok()) << end.status().message();
  ASSERT_EQ(end->state, JobState::kDone) << end->message << farm.Logs();
  EXPECT_EQ(end->result.Hex(), reference.Hex());
  // What was rendered twice is counted once.
  EXPECT_EQ(end->samples, 96u * 96u * 256u);
}

TEST(SameBits, WithAWorkerStoppedAndContinued) {
  const TestScene scene = LongJob();
  const Digest reference = Reference(scene);
  TcpFarm farm(/*silence_s=*/1);
  Process& stopped = farm.StartWorker(1);
  farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(2)) << farm.Logs();
  const absl::StatusOr<JobId> job = SubmitJob(farm.client(), scene);
  ASSERT_TRUE(job.ok()) << job.status().message();
  ASSERT_TRUE(AwaitFraction(farm.client(), *job, 0.05));
  stopped.Signal(SIGSTOP);
  const absl::StatusOr<JobStatus> end = AwaitEnd(farm.client(), *job);
  ASSERT_TRUE(end.ok()) << end.status().message();
  ASSERT_EQ(end->state, JobState::kDone) << end->message << farm.Logs();
  EXPECT_EQ(end->result.Hex(), reference.Hex());
  stopped.Signal(SIGCONT);
  // Its late results do no harm, and it serves again.
  ASSERT_TRUE(farm.AwaitWorkers(2)) << farm.Logs();
  EXPECT_EQ(farm.client().Get(*job)->result.Hex(), reference.Hex());
  const absl::StatusOr<Digest> again = RunJob(farm.client(), scene);
  ASSERT_TRUE(again.ok()) << again.status().message();
  EXPECT_EQ(again->Hex(), reference.Hex());
}

TEST(SameBits, AfterTheCoordinatorWasKilled) {
  const TestScene scene = LongJob();
  TcpFarm farm;
  Process& worker = farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(1)) << farm.Logs();
  const absl::StatusOr<JobId> job = SubmitJob(farm.client(), scene);
  ASSERT_TRUE(job.ok()) << job.status().message();
  ASSERT_TRUE(AwaitFraction(farm.client(), *job, 0.05));
  farm.coordinator().Signal(SIGKILL);
  farm.coordinator().Wait();
  EXPECT_TRUE(worker.Running());
  farm.StartCoordinator();
  ASSERT_TRUE(farm.AwaitWorkers(1)) << farm.Logs();
  const absl::StatusOr<Digest> digest = RunJob(farm.client(), scene);
  ASSERT_TRUE(digest.ok()) << digest.status().message();
  EXPECT_EQ(digest->Hex(), Reference(scene).Hex());
  worker.Signal(SIGTERM);
  EXPECT_EQ(worker.Wait(), 0) << farm.Logs();
  farm.coordinator().Signal(SIGTERM);
  EXPECT_EQ(farm.coordinator().Wait(), 0) << farm.Logs();
}

}  // namespace
}  // namespace strata
