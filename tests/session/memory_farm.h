#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "common/sync.h"
#include "coordinator/farm.h"
#include "worker/session/worker_session.h"

// A farm and its workers in one process without a network, and an engine that renders numbers
// instead of light: what the cores do between them, for the thread sanitizer too.

namespace strata {

/// A directory that is removed with this object.
class ScratchDirectory {
 public:
  ScratchDirectory();
  ~ScratchDirectory();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// What the engine of tests does with a scene, read from its file: "scene" renders; "broken" fails
/// to load for good; "refuses" fails each unit; "slow" renders until cancelled.
std::unique_ptr<RenderEngine> NewNumberEngine();

/// How a connection treats messages; probabilities from 0 to 1.
struct Weather {
  double delay = 0;      ///< Of waiting up to a millisecond before a message is delivered.
  double duplicate = 0;  ///< Of a result being delivered twice.
  double reorder = 0;    ///< Of a result being delivered after the next message.
};

/// One worker connected to a farm through queues and two threads, as gRPC would.
class MemoryConnection {
 public:
  MemoryConnection(Farm& farm, WorkerSession& session, Weather weather, uint32_t seed);
  /// Breaks the connection: what is queued either way is lost.
  ~MemoryConnection();
  /// Whether the farm ended the connection.
  bool Closed() const;

 private:
  struct Queues;
  class WorkerSide;
  class FarmSide;
  void ToFarm();
  void ToSession();

  Farm& farm_;
  WorkerSession& session_;
  const Weather weather_;
  std::mt19937 random_;  ///< ToFarm's alone.
  std::shared_ptr<Queues> queues_;
  std::thread to_farm_, to_session_;
};

/// A worker's session with its cache, connected or not.
class MemoryWorker {
 public:
  explicit MemoryWorker(std::filesystem::path cache_directory,
                        std::unique_ptr<RenderEngine> engine = NewNumberEngine());
  ~MemoryWorker();
  void Connect(Farm& farm, Weather weather, uint32_t seed);
  void Disconnect();
  bool Connected() const { return connection_ != nullptr; }
  WorkerSession& session() { return *session_; }
  /// What the session said when it left last.
  absl::Status AwaitLeave();

 private:
  Mutex mutex_;
  CondVar changed_;
  std::optional<absl::Status> left_ STRATA_GUARDED_BY(mutex_);
  std::unique_ptr<WorkerSession> session_;
  std::unique_ptr<MemoryConnection> connection_;
};

/// A farm with its clock.
class MemoryFarm {
 public:
  explicit MemoryFarm(std::filesystem::path state_directory);
  ~MemoryFarm();
  Farm& farm() { return *farm_; }
  /// A job over a scene file with this content.
  JobSpec Spec(const std::string& scene_text);
  JobStatus AwaitEnd(const JobId& job);

 private:
  std::unique_ptr<Farm> farm_;
  std::atomic<bool> stopping_ = false;
  std::thread clock_;
};

}  // namespace strata
