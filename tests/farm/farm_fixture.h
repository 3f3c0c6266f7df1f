#pragma once

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <deque>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/sync.h"
#include "coordinator/farm.h"
#include "tests/farm/fake_renderer.h"

namespace strata {

/// A directory of its own for one test, removed at its end.
class TestDirectory {
 public:
  TestDirectory() {
    std::string pattern = (std::filesystem::temp_directory_path() / "strata-test-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TestDirectory() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Keeps what the farm says to a worker.
class FakeLink final : public WorkerLink {
 public:
  void Send(ToWorker message) override {
    MutexLock lock(mutex_);
    messages_.push_back(std::move(message));
  }
  void Close() override {
    MutexLock lock(mutex_);
    closed_ = true;
  }

  /// What was said since the last call.
  std::deque<ToWorker> Take() {
    MutexLock lock(mutex_);
    return std::exchange(messages_, {});
  }
  bool closed() {
    MutexLock lock(mutex_);
    return closed_;
  }

 private:
  Mutex mutex_;
  std::deque<ToWorker> messages_ STRATA_GUARDED_BY(mutex_);
  bool closed_ STRATA_GUARDED_BY(mutex_) = false;
};

inline Hello TestHello(const std::string& name) {
  Hello hello;
  hello.build = "test";
  hello.kernel_revision = 1;
  hello.isa = "avx2";
  hello.name = name;
  hello.threads = 1;
  return hello;
}

/// A worker without threads or time of its own: it does one thing when it is told to.
class FakeWorker {
 public:
  FakeWorker(Farm& farm, const Hello& hello, SteadyTime now)
      : farm_(farm), link_(std::make_shared<FakeLink>()) {
    id_ = farm_.Connect(hello, link_, now);
  }

  const std::string& id() const { return id_; }
  FakeLink& link() { return *link_; }
  const std::deque<std::pair<Lease, WorkUnit>>& todo() { return Listen(), todo_; }
  const std::vector<Refusal>& refusals() { return Listen(), refusals_; }
  int leases_granted() { return Listen(), leases_granted_; }
  int leases_cancelled() { return Listen(), leases_cancelled_; }
  int drains() { return Listen(), drains_; }
  /// Samples of each job this worker rendered.
  const std::map<JobId, uint64_t>& rendered() const { return rendered_; }

  /// Renders the next unit and keeps its result; nothing when there is none to render.
  std::optional<UnitResult> Render() {
    Listen();
    if (todo_.empty()) return std::nullopt;
    const auto [lease, unit] = std::move(todo_.front());
    todo_.pop_front();
    UnitResult result{lease.job, lease.lease, FakeRender(specs_.at(lease.job), unit)};
    for (const uint32_t n : result.partial.samples)
      rendered_[lease.job] += uint64_t{kReplicates} * n;
    return result;
  }
  /// Renders the next unit and sends it; false when there is none.
  bool RenderAndSend(SteadyTime now) {
    std::optional<UnitResult> result = Render();
    if (!result) return false;
    Send(*std::move(result), now);
    return true;
  }
  /// Says that the next unit cannot be rendered; false when there is none.
  bool Fail(const std::string& reason, const std::string& replay, bool job_wide, SteadyTime now) {
    Listen();
    if (todo_.empty()) return false;
    const auto [lease, unit] = std::move(todo_.front());
    todo_.pop_front();
    Send(UnitFailure{lease.job, lease.lease, unit.id, reason, replay, job_wide}, now);
    return true;
  }
  void Send(FromWorker message, SteadyTime now) { farm_.Receive(id_, std::move(message), now); }
  void Vanish(SteadyTime now) { farm_.Disconnect(id_, now); }

 private:
  void Listen() {
    for (ToWorker& message : link_->Take()) {
      if (auto* description = std::get_if<JobDescription>(&message)) {
        specs_[description->job] = description->spec;
      } else if (auto* lease = std::get_if<Lease>(&message)) {
        ++leases_granted_;
        for (const WorkUnit& unit : lease->units) todo_.emplace_back(*lease, unit);
      } else if (auto* cancel_lease = std::get_if<CancelLease>(&message)) {
        ++leases_cancelled_;
        std::erase_if(todo_, [&](const auto& e) { return e.first.lease == cancel_lease->lease; });
      } else if (auto* cancel_job = std::get_if<CancelJob>(&message)) {
        std::erase_if(todo_, [&](const auto& e) { return e.first.job == cancel_job->job; });
      } else if (auto* refusal = std::get_if<Refusal>(&message)) {
        refusals_.push_back(*refusal);
      } else if (std::holds_alternative<Drain>(message)) {
        ++drains_;
      }
    }
  }

  Farm& farm_;
  std::shared_ptr<FakeLink> link_;
  std::string id_;
  std::map<JobId, JobSpec> specs_;
  std::deque<std::pair<Lease, WorkUnit>> todo_;
  std::vector<Refusal> refusals_;
  std::map<JobId, uint64_t> rendered_;
  int leases_granted_ = 0, leases_cancelled_ = 0, drains_ = 0;
};

/// A farm with a simulated clock.
class FarmTest : public ::testing::Test {
 protected:
  void SetUp() override {
    spdlog::set_level(spdlog::level::err);
    FarmOptions options;
    options.state_dir = directory_.path();
    options.build = "test";
    options.kernel_revision = 1;
    std::unique_ptr<JobStore> store = NewMemoryJobStore();
    store_ = store.get();
    auto farm = Farm::Create(options, std::move(store));
    ASSERT_TRUE(farm.ok()) << farm.status();
    farm_ = *std::move(farm);
    const std::string scene = "a scene";
    scene_ = {"scene.pbrt", DigestOf(scene), scene.size()};
    auto upload = farm_->BeginUpload(scene_.digest, scene.size());
    ASSERT_TRUE(upload.ok()) << upload.status();
    ASSERT_TRUE((*upload)->Append(scene).ok());
    ASSERT_TRUE((*upload)->Finish().ok());
  }

  JobSpec Spec(int width, int height, uint32_t spp, int tile = 8) const {
    JobSpec spec;
    spec.name = "test";
    spec.bundle = {"scene.pbrt", {scene_}};
    spec.width = width;
    spec.height = height;
    spec.crop = {0, 0, width, height};
    spec.spp = spp;
    spec.tile = tile;
    return spec;
  }
  JobId Submit(const JobSpec& spec, const std::string& request_id = "") {
    const auto job = farm_->Submit(spec, request_id, now_);
    EXPECT_TRUE(job.ok()) << job.status();
    return job.value_or("");
  }
  FakeWorker& Join(const std::string& name = "worker") { return Join(TestHello(name)); }
  FakeWorker& Join(const Hello& hello) { return workers_.emplace_back(*farm_, hello, now_); }
  JobStatus Status(const JobId& job) const { return *farm_->Get(job); }

  /// Time passes in steps of a tick, so that it does not look like a stall of the farm.
  void Pass(std::chrono::milliseconds time) {
    for (auto t = std::chrono::milliseconds(0); t < time; t += kTick) {
      now_ += kTick;
      farm_->Tick(now_);
    }
  }
  /// All workers render one unit each in turn until none has any. Each unit takes a tick.
  void RunAll() {
    for (bool busy = true; busy;) {
      busy = false;
      for (FakeWorker& worker : workers_) busy |= worker.RenderAndSend(now_);
      Pass(kTick);
    }
  }
  /// As the picture has them, over all pixels.
  uint64_t SamplesInImage(const JobId& job) const {
    const auto image = farm_->Image(job);
    EXPECT_TRUE(image.ok());
    const size_t channels = image->channels.size();
    double samples = 0;
    for (size_t i = 0; i < image->values.size(); i += channels) {
      samples += image->values[i + channels - 2];
    }
    return static_cast<uint64_t>(samples);
  }
  std::string LogText(const JobId& job) const {
    std::string text;
    const std::vector<LogLine> lines = farm_->Logs(job).value();
    for (const LogLine& line : lines) text += line.level + ": " + line.text + "\n";
    return text;
  }

  static constexpr std::chrono::milliseconds kTick{100};
  TestDirectory directory_;
  BundleFile scene_;
  SteadyTime now_{std::chrono::hours(1)};
  const JobStore* store_ = nullptr;  ///< The farm's; to be looked into while the farm rests.
  std::unique_ptr<Farm> farm_;
  std::deque<FakeWorker> workers_;
};

/// Digests of jobs rendered by unruly workers.
class AnyWorkers : public FarmTest {
 protected:
  /// The digest of a job rendered by some workers in an order drawn from `seed`: results are kept
  /// back, sent out of order and sent twice, and workers vanish and come.
  Digest DigestWith(JobSpec spec, size_t workers, uint64_t seed) {
    workers_.clear();
    const JobId job = Submit(spec);
    for (size_t i = 0; i < workers; ++i) Join("worker-" + std::to_string(i));
    std::vector<std::pair<FakeWorker*, UnitResult>> kept;
    std::set<FakeWorker*> gone;
    int vanished = 0;
    for (uint32_t step = 0; !IsFinal(Status(job).state) && step < 100000; ++step) {
      const auto draw = [&](int what) { return FakeUniform(seed, what, 0, 0, step, 0); };
      FakeWorker& worker = workers_[static_cast<size_t>(draw(0) * workers_.size())];
      if (gone.contains(&worker)) continue;
      if (auto result = worker.Render()) kept.emplace_back(&worker, *std::move(result));
      if (!kept.empty() && draw(1) < 0.7) {
        const size_t which = static_cast<size_t>(draw(2) * kept.size());
        auto [from, result] = kept[which];
        if (draw(3) < 0.7) kept.erase(kept.begin() + static_cast<ptrdiff_t>(which));
        from->Send(result, now_);
      }
      if (draw(4) < 0.02 && vanished < 2) {
        ++vanished;
        worker.Vanish(now_);
        gone.insert(&worker);
        Join("replacement");
      }
      Pass(kTick);
    }
    EXPECT_EQ(Status(job).state, JobState::kDone) << LogText(job);
    return Status(job).result;
  }
};

}  // namespace strata
