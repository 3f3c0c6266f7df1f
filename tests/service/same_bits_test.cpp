#include <gtest/gtest.h>
#include <signal.h>

#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "tests/all_samplers.h"
#include "tests/service/farm_under_test.h"

namespace strata {
namespace {

/// The end of `scene` on one worker with one thread.
JobStatus Reference(const TestScene& scene) {
  InProcessFarm farm(1, 1);
  const absl::StatusOr<JobId> job = SubmitJob(farm.client(), scene);
  EXPECT_TRUE(job.ok()) << job.status().message();
  if (!job.ok()) return {};
  const absl::StatusOr<JobStatus> end = AwaitEnd(farm.client(), *job);
  EXPECT_TRUE(end.ok()) << end.status().message();
  return end.value_or(JobStatus{});
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

/// The same in two rounds: a pilot of 32 samples, and some where the error is.
TestScene SmallByRing(TestScene scene) {
  scene = Small(std::move(scene));
  scene.spec.allocation = AllocationKind::kRing;
  scene.spec.spp = 40;
  scene.spec.max_depth = 2;
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
  std::vector<TestScene> scenes = {Small(OwnScene("cornell-box/cornell-box.pbrt")),
                                   SmallByRing(OwnScene("textures/textures.pbrt"))};
  const std::optional<TestScene> coffee = SharedScene("coffee");
  if (coffee) scenes.push_back(Small(*coffee));
  std::vector<KnownScene> known;
  for (const TestScene& scene : scenes) {
    const JobStatus reference = Reference(scene);
    const bool ring = scene.spec.allocation == AllocationKind::kRing;
    ASSERT_EQ(reference.rounds, ring ? 2u : 1u);
    known.push_back({scene, reference.result});
  }

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

TEST(SameBits, OfEverySampler) {
  std::vector<KnownScene> known;
  std::set<std::string> digests;
  for (const SamplerKind sampler : kAllSamplers) {
    TestScene scene = Small(OwnScene("cornell-box/cornell-box.pbrt"));
    scene.spec.sampler = sampler;
    scene.spec.name = std::string(ToString(sampler));
    known.push_back({scene, Reference(scene).result});
    digests.insert(known.back().digest.Hex());
  }
  EXPECT_EQ(digests.size(), std::size(kAllSamplers)) << "each sampler is another";
  InProcessFarm farm(3, 2);
  ExpectSameBits(farm.client(), known, "3 workers of 2 threads");
}

TEST(SameBits, OfEveryChoiceOfLightsAndRoutines) {
  const TestScene garland = Small(OwnScene("garland/garland.pbrt"));
  std::vector<TestScene> scenes(5, garland);
  scenes[1].spec.bundle.options.light_selection = LightSelection::kIntensity;
  scenes[2].spec.bundle.options.light_selection = LightSelection::kUniform;
  scenes[3].spec.routines = SamplingRoutines::kPlain;
  scenes[4].spec.routines = SamplingRoutines::kRejection;
  std::vector<KnownScene> known;
  std::set<std::string> digests;
  for (const TestScene& scene : scenes) {
    known.push_back({scene, Reference(scene).result});
    digests.insert(known.back().digest.Hex());
  }
  EXPECT_EQ(digests.size(), scenes.size()) << "each choice is another";
  InProcessFarm farm(3, 2);
  ExpectSameBits(farm.client(), known, "3 workers of 2 threads");
}

TEST(SameBits, NotWithAnotherSeed) {
  std::vector<TestScene> scenes = {Small(OwnScene("cornell-box/cornell-box.pbrt")),
                                   SmallByRing(OwnScene("textures/textures.pbrt"))};
  if (const std::optional<TestScene> coffee = SharedScene("coffee"))
    scenes.push_back(Small(*coffee));
  for (const TestScene& scene : scenes) {
    TestScene other = scene;
    ++other.spec.seed;
    EXPECT_NE(Reference(other).result.Hex(), Reference(scene).result.Hex()) << scene.root;
  }
}

// ---- farms that are disturbed while they render ----

/// A job of about a second of one thread, of many tiles with several pieces each.
TestScene Long(TestScene scene) {
  scene.spec.width = scene.spec.height = 40;
  scene.spec.crop = {0, 0, 40, 40};
  scene.spec.spp = 512;
  scene.spec.tile = 16;
  return scene;
}

TestScene LongUniform() { return Long(OwnScene("cornell-box/cornell-box.pbrt")); }

TestScene LongByRing() {
  TestScene scene = Long(OwnScene("textures/textures.pbrt"));
  scene.spec.allocation = AllocationKind::kRing;
  return scene;
}

/// Rounds until the error is small enough; of the project's own scene where coffee is not there.
TestScene LongToError() {
  TestScene scene = Long(SharedScene("coffee").value_or(OwnScene("cornell-box/cornell-box.pbrt")));
  scene.spec.allocation = AllocationKind::kRing;
  scene.spec.target = TargetKind::kRelativeError;
  scene.spec.target_value = 0.3;
  scene.spec.spp = 4096;
  return scene;
}

/// A uniform job, one by ring and one to an error, which are rendered at the same time.
class LongJobs {
 public:
  LongJobs() {
    for (const TestScene& scene : {LongUniform(), LongByRing(), LongToError()}) {
      jobs_.push_back({scene, Reference(scene), {}});
      EXPECT_GT(CutPieces({0, scene.spec.spp / kReplicates}).size(), 1u);
    }
    EXPECT_EQ(jobs_[0].reference.rounds, 1u);
    EXPECT_EQ(jobs_[1].reference.rounds, 2u);
    EXPECT_GT(jobs_[2].reference.rounds, 1u);
    EXPECT_TRUE(jobs_[2].reference.target_met);
  }

  void Submit(FarmClient& client) {
    for (Job& job : jobs_) {
      const absl::StatusOr<JobId> id = SubmitJob(client, job.scene);
      ASSERT_TRUE(id.ok()) << id.status().message();
      job.id = *id;
    }
  }

  /// Waits until each has come so far; false when one has ended.
  bool AwaitFraction(FarmClient& client, double fraction) const {
    bool under_way = true, so_far = false;
    const bool in_time = Eventually([&] {
      so_far = true;
      for (const Job& job : jobs_) {
        const absl::StatusOr<JobStatus> status = client.Get(job.id);
        under_way &= status.ok() && !IsFinal(status->state);
        so_far &= status.ok() && status->fraction >= fraction;
      }
      return so_far || !under_way;
    });
    return in_time && under_way;
  }
  /// That a signal was sent before it ended proves that it disturbed it.
  bool AllUnderWay(FarmClient& client) const { return AwaitFraction(client, 0); }

  void ExpectSameBits(FarmClient& client) const {
    for (const Job& job : jobs_) {
      const absl::StatusOr<JobStatus> end = AwaitEnd(client, job.id);
      ASSERT_TRUE(end.ok()) << end.status().message();
      EXPECT_EQ(end->state, JobState::kDone) << end->message;
      EXPECT_EQ(end->result.Hex(), job.reference.result.Hex()) << job.scene.root;
      // What was rendered twice is counted once.
      EXPECT_EQ(end->samples, job.reference.samples);
      EXPECT_EQ(end->rounds, job.reference.rounds);
    }
  }

 private:
  struct Job {
    TestScene scene;
    JobStatus reference;
    JobId id;
  };
  std::vector<Job> jobs_;
};

std::optional<WorkerStatus> FindWorker(FarmClient& client, const std::string& name) {
  const absl::StatusOr<std::vector<WorkerStatus>> workers = client.Workers();
  EXPECT_TRUE(workers.ok()) << workers.status().message();
  if (!workers.ok()) return std::nullopt;
  for (const WorkerStatus& worker : *workers) {
    if (worker.name == name) return worker;
  }
  return std::nullopt;
}

TEST(SameBits, WithWorkersKilledAndJoinedWhileItRenders) {
  LongJobs jobs;
  TcpFarm farm;
  Process& first = farm.StartWorker(1);
  Process& second = farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(2)) << farm.Logs();
  jobs.Submit(farm.client());
  ASSERT_TRUE(jobs.AwaitFraction(farm.client(), 0.05)) << farm.Logs();
  first.Signal(SIGKILL);
  ASSERT_TRUE(jobs.AllUnderWay(farm.client()));
  farm.StartWorker(4);
  ASSERT_TRUE(jobs.AwaitFraction(farm.client(), 0.2)) << farm.Logs();
  second.Signal(SIGKILL);
  ASSERT_TRUE(jobs.AllUnderWay(farm.client()));
  jobs.ExpectSameBits(farm.client());
  if (HasFailure()) ADD_FAILURE() << farm.Logs();
}

TEST(SameBits, WithAWorkerStoppedAndContinued) {
  LongJobs jobs;
  TcpFarm farm(/*silence_s=*/0.5);
  Process& stopped = farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(1)) << farm.Logs();
  jobs.Submit(farm.client());
  ASSERT_TRUE(jobs.AwaitFraction(farm.client(), 0.05)) << farm.Logs();
  ASSERT_GT(FindWorker(farm.client(), "worker-0")->leases, 0);
  stopped.Signal(SIGSTOP);
  ASSERT_TRUE(Eventually([&] {
    const std::optional<WorkerStatus> worker = FindWorker(farm.client(), "worker-0");
    return worker && worker->state == "lost" && worker->leases == 0;
  })) << farm.Logs();
  ASSERT_TRUE(jobs.AllUnderWay(farm.client())) << "they waited for a worker";
  // Another one takes the leases; the first is awake again while it renders, with late results.
  farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(1)) << farm.Logs();
  ASSERT_TRUE(jobs.AwaitFraction(farm.client(), 0.2)) << farm.Logs();
  stopped.Signal(SIGCONT);
  ASSERT_TRUE(jobs.AllUnderWay(farm.client()));
  jobs.ExpectSameBits(farm.client());
  // It serves again.
  ASSERT_TRUE(farm.AwaitWorkers(2)) << farm.Logs();
  if (HasFailure()) ADD_FAILURE() << farm.Logs();
}

TEST(SameBits, AfterTheCoordinatorWasKilled) {
  const TestScene scene = LongByRing();
  TcpFarm farm;
  Process& worker = farm.StartWorker(1);
  ASSERT_TRUE(farm.AwaitWorkers(1)) << farm.Logs();
  const absl::StatusOr<JobId> job = SubmitJob(farm.client(), scene);
  ASSERT_TRUE(job.ok()) << job.status().message();
  ASSERT_TRUE(Eventually([&] { return farm.client().Get(*job)->fraction >= 0.05; }));
  ASSERT_FALSE(IsFinal(farm.client().Get(*job)->state));
  farm.coordinator().Signal(SIGKILL);
  farm.coordinator().Wait();
  EXPECT_TRUE(worker.Running());
  farm.StartCoordinator();
  ASSERT_TRUE(farm.AwaitWorkers(1)) << farm.Logs();
  const absl::StatusOr<Digest> digest = RunJob(farm.client(), scene);
  ASSERT_TRUE(digest.ok()) << digest.status().message();
  EXPECT_EQ(digest->Hex(), Reference(scene).result.Hex());
  worker.Signal(SIGTERM);
  EXPECT_EQ(worker.Wait(), 0) << farm.Logs();
  farm.coordinator().Signal(SIGTERM);
  EXPECT_EQ(farm.coordinator().Wait(), 0) << farm.Logs();
}

}  // namespace
}  // namespace strata
