#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <random>
#include <set>
#include <tuple>
#include <utility>

#include "coordinator/farm.h"
#include "tests/service/farm_under_test.h"
#include "worker/integrator/render.h"

// Light that arrives in any order, and twice: units of real scenes, rendered by the worker's
// renderer and handed to the farm by workers without a network, whose every choice is drawn from
// a seed.

namespace strata {
namespace {

class QueueLink final : public WorkerLink {
 public:
  void Send(ToWorker message) override { messages.push_back(std::move(message)); }
  void Close() override {}
  std::deque<ToWorker> messages;
};

/// How far from a quiet run it was.
struct Disorder {
  int duplicates = 0;   ///< Results sent again.
  int overtakings = 0;  ///< Results of a tile that came before an earlier one.
};

/// A farm with one job, and workers that keep results back.
class ShuffledRun {
 public:
  ShuffledRun(const TestScene& scene, uint64_t seed) : scene_(scene), random_(seed), pool_(2) {
    FarmOptions options;
    options.state_dir = directory_ / "state";
    options.build = "test";
    options.kernel_revision = kKernelRevision;
    auto farm = Farm::Create(options, NewMemoryJobStore());
    EXPECT_TRUE(farm.ok()) << farm.status();
    farm_ = *std::move(farm);
    auto loaded = LoadScene(DirectorySource(scene.root), scene.spec.bundle.scene);
    EXPECT_TRUE(loaded.ok()) << loaded.status();
    auto renderer = Renderer::Create(*loaded, scene.spec);
    EXPECT_TRUE(renderer.ok()) << renderer.status();
    renderer_ = *std::move(renderer);
  }

  JobStatus Run(Disorder* disorder) {
    for (const BundleFile& file : scene_.spec.bundle.files) Upload(file);
    const absl::StatusOr<JobId> job = farm_->Submit(scene_.spec, "shuffled", now_);
    EXPECT_TRUE(job.ok()) << job.status();
    for (const std::string name : {"a", "b", "c", "d", "e"}) Join(name);
    std::vector<Kept> kept;
    while (!IsFinal(farm_->Get(*job)->state)) {
      for (Worker& worker : workers_) RenderLeases(worker, kept);
      if (kept.empty()) break;  // Nothing can come any more.
      std::shuffle(kept.begin(), kept.end(), random_);
      // Half of them now, and one in three of these once more, later.
      std::vector<Kept> later(kept.begin() + static_cast<ptrdiff_t>((kept.size() + 1) / 2),
                              kept.end());
      kept.resize((kept.size() + 1) / 2);
      for (Kept& result : kept) {
        Deliver(result, *disorder);
        if (random_() % 3 == 0) later.push_back(result);
      }
      kept = std::move(later);
      now_ += std::chrono::milliseconds(100);
      farm_->Tick(now_);
    }
    return *farm_->Get(*job);
  }

 private:
  struct Worker {
    std::string id;
    std::shared_ptr<QueueLink> link;
  };
  struct Kept {
    std::string worker;
    UnitResult result;
  };

  void Upload(const BundleFile& file) {
    std::ifstream stream(scene_.root / file.path, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    auto upload = farm_->BeginUpload(file.digest, file.bytes);
    ASSERT_TRUE(upload.ok()) << upload.status();
    ASSERT_TRUE((*upload)->Append(bytes).ok());
    ASSERT_TRUE((*upload)->Finish().ok());
  }

  void Join(const std::string& name) {
    Hello hello;
    hello.build = "test";
    hello.kernel_revision = kKernelRevision;
    hello.name = name;
    hello.threads = 1;
    auto link = std::make_shared<QueueLink>();
    const std::string id = farm_->Connect(hello, link, now_);
    workers_.push_back({id, std::move(link)});
  }

  void RenderLeases(Worker& worker, std::vector<Kept>& kept) {
    for (const ToWorker& message : std::exchange(worker.link->messages, {})) {
      const auto* lease = std::get_if<Lease>(&message);
      if (lease == nullptr) continue;
      for (const WorkUnit& unit : lease->units) {
        absl::StatusOr<Partial> partial = renderer_->Render(unit, pool_);
        ASSERT_TRUE(partial.ok()) << partial.status();
        kept.push_back({worker.id, {lease->job, lease->lease, *std::move(partial)}});
      }
    }
  }

  void Deliver(const Kept& kept, Disorder& disorder) {
    const UnitId& unit = kept.result.partial.unit;
    std::set<uint32_t>& pieces = delivered_[{unit.round, unit.tile}];
    if (pieces.contains(unit.piece))
      ++disorder.duplicates;
    else if (pieces.size() < unit.piece)
      ++disorder.overtakings;
    pieces.insert(unit.piece);
    farm_->Receive(kept.worker, kept.result, now_);
  }

  const TestScene scene_;
  std::mt19937_64 random_;
  RenderPool pool_;
  ScratchDirectory directory_;
  SteadyTime now_{std::chrono::hours(1)};
  std::unique_ptr<Farm> farm_;
  std::unique_ptr<Renderer> renderer_;
  std::vector<Worker> workers_;
  std::map<std::tuple<uint32_t, uint32_t>, std::set<uint32_t>> delivered_;
};

class ShuffledResults : public testing::TestWithParam<std::tuple<const char*, AllocationKind>> {};

TEST_P(ShuffledResults, GiveTheSameBits) {
  const auto [path, allocation] = GetParam();
  TestScene scene = OwnScene(path);
  scene.spec.width = scene.spec.height = 32;
  scene.spec.crop = {0, 0, 32, 32};
  scene.spec.tile = 16;
  scene.spec.spp = 8 * 62;  // Pieces of 32, 16, 8, 4 and 2 of each replicate.
  scene.spec.allocation = allocation;

  InProcessFarm farm(1, 2);
  const absl::StatusOr<Digest> plain = RunJob(farm.client(), scene);
  ASSERT_TRUE(plain.ok()) << plain.status();
  Disorder disorder;
  const JobStatus end = ShuffledRun(scene, 1).Run(&disorder);
  EXPECT_EQ(end.state, JobState::kDone) << end.message;
  EXPECT_EQ(end.rounds, allocation == AllocationKind::kRing ? 2u : 1u);
  EXPECT_EQ(end.result.Hex(), plain->Hex());
  EXPECT_GE(disorder.duplicates, 4);
  EXPECT_GE(disorder.overtakings, 4);
}

INSTANTIATE_TEST_SUITE_P(
    SameBits, ShuffledResults,
    testing::Combine(testing::Values("cornell-box/cornell-box.pbrt", "textures/textures.pbrt"),
                     testing::Values(AllocationKind::kUniform, AllocationKind::kRing)),
    [](const auto& info) {
      const std::string path = std::get<0>(info.param);
      return std::string(path.starts_with("cornell") ? "CornellBox" : "Textures") +
             (std::get<1>(info.param) == AllocationKind::kRing ? "ByRing" : "Uniform");
    });

}  // namespace
}  // namespace strata
