#include "tests/session/memory_farm.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>
#include <fstream>
#include <utility>

namespace strata {
namespace {

void Nap(int microseconds) { std::this_thread::sleep_for(std::chrono::microseconds(microseconds)); }

struct NumberScene final : LoadedScene {
  std::string text;
};

/// Values that depend on pixel, sample and seed alone, as light would.
class NumberRenderer final : public UnitRenderer {
 public:
  NumberRenderer(std::string text, JobSpec spec) : text_(std::move(text)), spec_(std::move(spec)) {}

  absl::StatusOr<Partial> Render(const WorkUnit& unit, const std::atomic<bool>& cancel) override {
    if (text_ == "refuses") return absl::InternalError("this unit cannot be rendered");
    while (text_ == "slow") {
      if (cancel) return absl::CancelledError("cancelled");
      Nap(200);
    }
    Partial partial;
    partial.unit = unit.id;
    partial.pixels = unit.pixels;
    partial.layout = LayoutOf(spec_);
    const auto pixels = static_cast<size_t>(unit.pixels.Pixels());
    for (size_t i = 0; i < pixels; ++i) {
      const SampleRange range = unit.RangeOf(static_cast<int64_t>(i));
      std::mt19937_64 random(spec_.seed * 1000003 + range.begin * 7919 + unit.id.tile * 31 + i);
      partial.samples.push_back(range.Count());
      partial.rays.push_back(8 * range.Count());
      partial.nonfinite.push_back(0);
      for (int d = 0; d < partial.layout.Doubles(); ++d) {
        partial.values.push_back(static_cast<double>(random() >> 11) * 0x1p-53);
      }
    }
    return partial;
  }

 private:
  const std::string text_;
  const JobSpec spec_;
};

class NumberEngine final : public RenderEngine {
 public:
  absl::StatusOr<std::shared_ptr<const LoadedScene>> Load(const FileSource& source,
                                                          const Bundle& bundle) override {
    STRATA_ASSIGN_OR_RETURN(const std::filesystem::path path, source.Locate(bundle.scene));
    auto scene = std::make_shared<NumberScene>();
    std::getline(std::ifstream(path), scene->text, '\n');
    if (scene->text == "broken") return absl::InvalidArgumentError("scene.txt:1: is broken");
    return scene;
  }

  absl::StatusOr<std::unique_ptr<UnitRenderer>> Prepare(std::shared_ptr<const LoadedScene> scene,
                                                        const JobSpec& spec) override {
    return std::make_unique<NumberRenderer>(static_cast<const NumberScene&>(*scene).text, spec);
  }
};

}  // namespace

ScratchDirectory::ScratchDirectory() {
  std::string name = (std::filesystem::temp_directory_path() / "strata-test-XXXXXX").string();
  EXPECT_NE(mkdtemp(name.data()), nullptr);
  path_ = name;
}

ScratchDirectory::~ScratchDirectory() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::unique_ptr<RenderEngine> NewNumberEngine() { return std::make_unique<NumberEngine>(); }

struct MemoryConnection::Queues {
  Mutex mutex;
  CondVar changed;
  std::deque<FromWorker> to_farm STRATA_GUARDED_BY(mutex);
  std::deque<ToWorker> to_session STRATA_GUARDED_BY(mutex);
  bool broken STRATA_GUARDED_BY(mutex) = false;
  bool closed STRATA_GUARDED_BY(mutex) = false;

  /// False when the connection broke.
  template <class Message>
  bool Take(std::deque<Message> Queues::*queue, Message* message) {
    MutexLock lock(mutex);
    while ((this->*queue).empty() && !broken) changed.Wait(mutex);
    if (broken) return false;
    *message = std::move((this->*queue).front());
    (this->*queue).pop_front();
    return true;
  }

  template <class Message>
  void Put(std::deque<Message> Queues::*queue, Message message) {
    {
      MutexLock lock(mutex);
      (this->*queue).push_back(std::move(message));
    }
    changed.NotifyAll();
  }
};

class MemoryConnection::WorkerSide final : public CoordinatorLink {
 public:
  explicit WorkerSide(std::shared_ptr<Queues> queues) : queues_(std::move(queues)) {}
  void Send(FromWorker message) override { queues_->Put(&Queues::to_farm, std::move(message)); }

 private:
  std::shared_ptr<Queues> queues_;
};

class MemoryConnection::FarmSide final : public WorkerLink {
 public:
  explicit FarmSide(std::shared_ptr<Queues> queues) : queues_(std::move(queues)) {}
  void Send(ToWorker message) override { queues_->Put(&Queues::to_session, std::move(message)); }
  void Close() override {
    MutexLock lock(queues_->mutex);
    queues_->closed = true;
  }

 private:
  std::shared_ptr<Queues> queues_;
};

MemoryConnection::MemoryConnection(Farm& farm, WorkerSession& session, Weather weather,
                                   uint32_t seed)
    : farm_(farm),
      session_(session),
      weather_(weather),
      random_(seed),
      queues_(std::make_shared<Queues>()) {
  to_farm_ = std::thread([this] { ToFarm(); });
  to_session_ = std::thread([this] { ToSession(); });
  session_.Attach(std::make_shared<WorkerSide>(queues_));
}

MemoryConnection::~MemoryConnection() {
  {
    MutexLock lock(queues_->mutex);
    queues_->broken = true;
  }
  queues_->changed.NotifyAll();
  to_farm_.join();
  to_session_.join();
  session_.Detach();
}

bool MemoryConnection::Closed() const {
  MutexLock lock(queues_->mutex);
  return queues_->closed;
}

void MemoryConnection::ToFarm() {
  std::uniform_real_distribution<double> chance(0, 1);
  std::string worker;
  std::optional<FromWorker> held;  // A result that lets the next message pass.
  FromWorker message;
  while (queues_->Take(&Queues::to_farm, &message)) {
    if (chance(random_) < weather_.delay) Nap(static_cast<int>(1000 * chance(random_)));
    if (const Hello* hello = std::get_if<Hello>(&message)) {
      worker = farm_.Connect(*hello, std::make_shared<FarmSide>(queues_), Now());
      continue;
    }
    const bool result = std::holds_alternative<UnitResult>(message);
    if (result && chance(random_) < weather_.duplicate) farm_.Receive(worker, message, Now());
    if (result && !held && chance(random_) < weather_.reorder) {
      held = std::move(message);
      continue;
    }
    farm_.Receive(worker, std::move(message), Now());
    if (held) farm_.Receive(worker, *std::exchange(held, std::nullopt), Now());
  }
  if (!worker.empty()) farm_.Disconnect(worker, Now());
}

void MemoryConnection::ToSession() {
  ToWorker message;
  while (queues_->Take(&Queues::to_session, &message)) session_.Receive(std::move(message));
}

MemoryWorker::MemoryWorker(std::filesystem::path cache_directory,
                           std::unique_ptr<RenderEngine> engine) {
  Hello hello;
  hello.build = "test";
  hello.kernel_revision = 1;
  hello.name = "memory";
  hello.threads = 1;
  auto cache = FileCache::Open(std::move(cache_directory), 1 << 20);
  EXPECT_TRUE(cache.ok()) << cache.status().message();
  session_ = std::make_unique<WorkerSession>(hello, *std::move(cache), std::move(engine),
                                             [this](const absl::Status& status) {
                                               MutexLock lock(mutex_);
                                               left_ = status;
                                               changed_.NotifyAll();
                                             });
}

MemoryWorker::~MemoryWorker() {
  Disconnect();
  session_.reset();
}

void MemoryWorker::Connect(Farm& farm, Weather weather, uint32_t seed) {
  connection_ = std::make_unique<MemoryConnection>(farm, *session_, weather, seed);
}

void MemoryWorker::Disconnect() { connection_.reset(); }

absl::Status MemoryWorker::AwaitLeave() {
  MutexLock lock(mutex_);
  while (!left_) changed_.Wait(mutex_);
  return *left_;
}

MemoryFarm::MemoryFarm(std::filesystem::path state_directory) {
  FarmOptions options;
  options.state_dir = std::move(state_directory);
  options.build = "test";
  options.kernel_revision = 1;
  options.heartbeat = std::chrono::milliseconds(20);
  auto farm = Farm::Create(options, NewMemoryJobStore());
  EXPECT_TRUE(farm.ok()) << farm.status().message();
  farm_ = *std::move(farm);
  clock_ = std::thread([this] {
    while (!stopping_) {
      farm_->Tick(Now());
      Nap(2000);
    }
  });
}

MemoryFarm::~MemoryFarm() {
  stopping_ = true;
  clock_.join();
}

JobSpec MemoryFarm::Spec(const std::string& scene_text) {
  JobSpec spec;
  const Digest digest = DigestOf(scene_text);
  auto upload = farm_->BeginUpload(digest, scene_text.size());
  EXPECT_TRUE(upload.ok()) << upload.status().message();
  EXPECT_TRUE((*upload)->Append(scene_text).ok());
  EXPECT_TRUE((*upload)->Finish().ok());
  spec.bundle = {"scene.txt", {{"scene.txt", digest, scene_text.size()}}};
  spec.width = spec.height = 64;
  spec.crop = {0, 0, 64, 64};
  spec.tile = 8;
  spec.spp = 512;
  return spec;
}

JobStatus MemoryFarm::AwaitEnd(const JobId& job) {
  while (true) {
    const absl::StatusOr<JobStatus> status = farm_->Get(job);
    EXPECT_TRUE(status.ok()) << status.status().message();
    if (!status.ok() || IsFinal(status->state)) return status.value_or(JobStatus());
    Nap(1000);
  }
}

}  // namespace strata
