#include <gtest/gtest.h>

#include <fstream>

#include "tests/session/memory_farm.h"

namespace strata {
namespace {

void Nap() { std::this_thread::sleep_for(std::chrono::milliseconds(1)); }

/// The digest of a job on one undisturbed worker.
std::string Reference(uint64_t seed) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  MemoryWorker worker(directory / "cache");
  worker.Connect(farm.farm(), {}, 1);
  JobSpec spec = farm.Spec("scene");
  spec.seed = seed;
  const absl::StatusOr<JobId> job = farm.farm().Submit(spec, "r", Now());
  EXPECT_TRUE(job.ok()) << job.status().message();
  const JobStatus end = farm.AwaitEnd(*job);
  EXPECT_EQ(end.state, JobState::kDone) << end.message;
  return end.result.Hex();
}

TEST(Session, SameBitsInAnyWeather) {
  const std::string reference = Reference(1);
  EXPECT_NE(Reference(2), reference);
  for (uint32_t round = 0; round < 4; ++round) {
    ScratchDirectory directory;
    MemoryFarm farm(directory / "state");
    std::vector<std::unique_ptr<MemoryWorker>> workers;
    const Weather weather{0.2, 0.3, 0.3};
    for (int i = 0; i < 3; ++i) {
      workers.push_back(std::make_unique<MemoryWorker>(directory / absl::StrCat("cache", i)));
      workers.back()->Connect(farm.farm(), weather, 10 * round + static_cast<uint32_t>(i));
    }
    JobSpec spec = farm.Spec("scene");
    spec.seed = 1;
    const JobId job = *farm.farm().Submit(spec, "r", Now());
    // Connections break and come back while it renders: twice, since a unit that goes down with
    // three workers fails its job, and on a slow machine that may be the same unit each time.
    int breaks = 2;
    std::mt19937 random(round);
    while (!IsFinal(farm.farm().Get(job)->state)) {
      MemoryWorker& victim = *workers[random() % workers.size()];
      if (!victim.Connected()) {
        victim.Connect(farm.farm(), weather, static_cast<uint32_t>(random()));
      } else if (breaks-- > 0) {
        victim.Disconnect();
      }
      for (unsigned naps = random() % 20; naps > 0; --naps) Nap();
      for (size_t i = 0; i < workers.size(); ++i) {
        if (!workers[i]->Connected()) workers[i]->Connect(farm.farm(), weather, 7);
      }
    }
    const JobStatus end = farm.AwaitEnd(job);
    ASSERT_EQ(end.state, JobState::kDone) << end.message;
    EXPECT_EQ(end.result.Hex(), reference);
    EXPECT_EQ(end.samples, 64u * 64u * 512u);
  }
}

TEST(Session, ABrokenSceneFailsItsJobWithTheReason) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  MemoryWorker worker(directory / "cache");
  worker.Connect(farm.farm(), {}, 1);
  const JobId job = *farm.farm().Submit(farm.Spec("broken"), "r", Now());
  const JobStatus end = farm.AwaitEnd(job);
  EXPECT_EQ(end.state, JobState::kFailed);
  EXPECT_NE(end.message.find("scene.txt:1: is broken"), std::string::npos) << end.message;
  // The worker is none the worse for it.
  const JobId good = *farm.farm().Submit(farm.Spec("scene"), "s", Now());
  EXPECT_EQ(farm.AwaitEnd(good).state, JobState::kDone);
}

TEST(Session, AUnitThatFailsOnThreeWorkersFailsItsJobWithAReplay) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  std::vector<std::unique_ptr<MemoryWorker>> workers;
  for (int i = 0; i < 3; ++i) {
    workers.push_back(std::make_unique<MemoryWorker>(directory / absl::StrCat("cache", i)));
    workers.back()->Connect(farm.farm(), {}, 1);
  }
  const JobId job = *farm.farm().Submit(farm.Spec("refuses"), "r", Now());
  const JobStatus end = farm.AwaitEnd(job);
  EXPECT_EQ(end.state, JobState::kFailed);
  EXPECT_NE(end.message.find("this unit cannot be rendered"), std::string::npos) << end.message;
  EXPECT_NE(end.message.find("strata replay scene.txt"), std::string::npos) << end.message;
}

TEST(Session, CancelStopsAUnitThatNeverEnds) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  MemoryWorker worker(directory / "cache");
  worker.Connect(farm.farm(), {}, 1);
  const JobId slow = *farm.farm().Submit(farm.Spec("slow"), "r", Now());
  while (farm.farm().Get(slow)->workers == 0) Nap();
  ASSERT_TRUE(farm.farm().Cancel(slow, Now()).ok());
  const JobId next = *farm.farm().Submit(farm.Spec("scene"), "s", Now());
  EXPECT_EQ(farm.AwaitEnd(next).state, JobState::kDone);
  EXPECT_EQ(farm.farm().Get(slow)->state, JobState::kCancelled);
}

/// What an engine has done and still holds.
struct EngineCounts {
  std::atomic<int> loads = 0, renderers = 0;
};

class CountedRenderer final : public UnitRenderer {
 public:
  CountedRenderer(std::unique_ptr<UnitRenderer> renderer, EngineCounts& counts)
      : renderer_(std::move(renderer)), counts_(counts) {
    ++counts_.renderers;
  }
  ~CountedRenderer() override { --counts_.renderers; }
  absl::StatusOr<Partial> Render(const WorkUnit& unit, const std::atomic<bool>& cancel) override {
    return renderer_->Render(unit, cancel);
  }

 private:
  std::unique_ptr<UnitRenderer> renderer_;
  EngineCounts& counts_;
};

class CountedEngine final : public RenderEngine {
 public:
  explicit CountedEngine(EngineCounts& counts) : counts_(counts) {}
  absl::StatusOr<std::shared_ptr<const LoadedScene>> Load(const FileSource& source,
                                                          const Bundle& bundle) override {
    ++counts_.loads;
    return engine_->Load(source, bundle);
  }
  absl::StatusOr<std::unique_ptr<UnitRenderer>> Prepare(std::shared_ptr<const LoadedScene> scene,
                                                        const JobSpec& spec) override {
    STRATA_ASSIGN_OR_RETURN(std::unique_ptr<UnitRenderer> renderer,
                            engine_->Prepare(std::move(scene), spec));
    return std::make_unique<CountedRenderer>(std::move(renderer), counts_);
  }

 private:
  const std::unique_ptr<RenderEngine> engine_ = NewNumberEngine();
  EngineCounts& counts_;
};

TEST(Session, ForgetsAnEndedJobAndKeepsItsScene) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  EngineCounts counts;
  MemoryWorker worker(directory / "cache", std::make_unique<CountedEngine>(counts));
  worker.Connect(farm.farm(), {}, 1);
  for (uint64_t seed = 0; seed < 3; ++seed) {
    JobSpec spec = farm.Spec("scene");
    spec.seed = seed;
    const JobId job = *farm.farm().Submit(spec, "", Now());
    EXPECT_EQ(farm.AwaitEnd(job).state, JobState::kDone);
    while (counts.renderers > 0) Nap();
  }
  EXPECT_EQ(counts.loads, 1);
}

TEST(Session, HeartbeatsComeWhileAUnitRenders) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  MemoryWorker worker(directory / "cache");
  worker.Connect(farm.farm(), {}, 1);
  const JobId slow = *farm.farm().Submit(farm.Spec("slow"), "r", Now());
  while (farm.farm().Get(slow)->workers == 0) Nap();
  // Silence falls back again and again, though the unit never ends.
  for (int beats = 0; beats < 3; ++beats) {
    const double before = farm.farm().Workers(Now())[0].silent_s;
    while (farm.farm().Workers(Now())[0].silent_s >= before) Nap();
    while (farm.farm().Workers(Now())[0].silent_s < 0.001) Nap();
  }
  ASSERT_TRUE(farm.farm().Cancel(slow, Now()).ok());
}

TEST(Session, DrainedWorkersFinishWhatTheyHoldAndLeave) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  MemoryWorker first(directory / "cache1");
  first.Connect(farm.farm(), {}, 1);
  const JobId job = *farm.farm().Submit(farm.Spec("scene"), "r", Now());
  while (farm.farm().Get(job)->samples == 0) Nap();
  first.session().Drain();
  EXPECT_TRUE(first.AwaitLeave().ok());
  MemoryWorker second(directory / "cache2");
  second.Connect(farm.farm(), {}, 2);
  EXPECT_EQ(farm.AwaitEnd(job).state, JobState::kDone);
}

TEST(Session, AnotherBuildIsRefusedWithASentence) {
  ScratchDirectory directory;
  MemoryFarm farm(directory / "state");
  auto cache = FileCache::Open(directory / "cache", 1 << 20);
  ASSERT_TRUE(cache.ok());
  Mutex mutex;
  CondVar changed;
  std::optional<absl::Status> left;
  Hello hello;
  hello.protocol = kProtocol + 1;
  hello.threads = 1;
  WorkerSession session(hello, *std::move(cache), NewNumberEngine(),
                        [&](const absl::Status& status) {
                          MutexLock lock(mutex);
                          left = status;
                          changed.NotifyAll();
                        });
  MemoryConnection connection(farm.farm(), session, {}, 1);
  MutexLock lock(mutex);
  while (!left) changed.Wait(mutex);
  EXPECT_FALSE(left->ok());
  EXPECT_NE(left->message().find("protocol"), std::string::npos) << left->message();
}

}  // namespace
}  // namespace strata
