#include <gtest/gtest.h>
#include <signal.h>

#include <string>
#include <tuple>
#include <vector>

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

/// More than one tile of any size, the last ones thin, each in two pieces.
TestScene Small(TestScene scene) {
  scene.spec.width = 66;
  scene.spec.height = 34;
  scene.spec.crop = {0, 0, 66, 34};
  scene.spec.spp = 24;
  scene.spec.max_depth = 3;
  return scene;
}

struct KnownScene {
  TestScene scene;
  Digest digest;
};

/// Submits each scene with tiles of every size, all at once, so that jobs mix on the workers.
void ExpectSameBits(FarmClient& client, const std::vector<KnownScene>& scenes,
                    const std::string& farm) {
  struct Submitted {
    const KnownScene* known;
    int tile;
    JobId job;
  };
  std::vector<Submitted> all;
  for (const KnownScene& known : scenes) {
    for (const int tile : {16, 32, 64}) {
      TestScene scene = known.scene;
      scene.spec.tile = tile;
      const absl::StatusOr<JobId> job = SubmitJob(client, scene);
      ASSERT_TRUE(job.ok()) << job.status().message();
      all.push_back({&known, tile, *job});
    }
  }
  for (const auto& [known, tile, job] : all) {
    const absl::StatusOr<JobStatus> end = AwaitEnd(client, job);
    ASSERT_TRUE(end.ok()) << end.status().message();
    ASSERT_EQ(end->state, JobState::kDone) << end->message;
    EXPECT_EQ(end->result.Hex(), known->digest.Hex())
        << known->scene.spec.name << " on " << farm << ", tile " << tile;
  }
}

enum class Transport { kInProcess, kTcp };

/// Every number of workers and of their threads, over either transport, on each scene.
class EveryFarm : public testing::TestWithParam<std::tuple<Transport, int>> {};

TEST_P(EveryFarm, GivesTheSameBits) {
  const auto [transport, workers] = GetParam();
  std::vector<TestScene> scenes = {OwnScene("cornell-box/cornell-box.pbrt"),
                                   OwnScene("textures/textures.pbrt")};
  const std::optional<TestScene> coffee = SharedScene("coffee");
  if (coffee) scenes.push_back(*coffee);
  std::vector<KnownScene> known;
  for (const TestScene& scene : scenes) known.push_back({Small(scene), Reference(Small(scene))});

  for (const uint32_t threads : {1, 4}) {
    const std::string name = absl::StrCat(workers, " workers of ", threads, " threads");
    if (transport == Transport::kInProcess) {
      InProcessFarm farm(workers, threads);
      ExpectSameBits(farm.client(), known, name);
    } else {
      TcpFarm farm;
      for (int i = 0; i < workers; ++i) farm.StartWorker(threads);
      ASSERT_TRUE(farm.AwaitWorkers(static_cast<size_t>(workers))) << farm.Logs();
      ExpectSameBits(farm.client(), known, name);
      if (HasFailure()) ADD_FAILURE() << farm.Logs();
    }
  }
  if (!coffee) GTEST_SKIP() << "the shared scene coffee is not there; the project's own agree";
}

INSTANTIATE_TEST_SUITE_P(SameBits, EveryFarm,
                         testing::Combine(testing::Values(Transport::kInProcess, Transport::kTcp),
                                          testing::Values(1, 2, 3, 7)),
                         [](const auto& info) {
                           const bool tcp = std::get<0>(info.param) == Transport::kTcp;
                           return absl::StrCat(tcp ? "Tcp" : "InProcess", std::get<1>(info.param));
                         });

TEST(SameBits, NotWithAnotherSeed) {
  const TestScene scene = Small(OwnScene("cornell-box/cornell-box.pbrt"));
  TestScene other = scene;
  ++other.spec.seed;
  EXPECT_NE(Reference(other).Hex(), Reference(scene).Hex());
}

/// A job that takes seconds of one thread, so that there is time to disturb it.
TestScene LongJob() {
  TestScene scene = OwnScene("cornell-box/cornell-box.pbrt");
  scene.spec.width = scene.spec.height = 96;
  scene.spec.crop = {0, 0, 96, 96};
  scene.spec.spp = 128;
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
  EXPECT_EQ(end->samples, 96u * 96u * 128u);
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
