#pragma once

#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <thread>

#include "common/sync.h"
#include "coordinator/farm.h"
#include "coordinator/worker_link.h"
#include "strata/v1/worker.grpc.pb.h"

namespace strata {

/// One worker's connection. Farm::Receive merges and may block while the merge queue is full, which
/// gRPC's few callback threads must not; so each stream has a thread of its own that takes messages
/// from a place for one, and a read is armed only while that place is empty. What a worker sends
/// beyond that waits in its own buffers (HTTP/2 flow control). Writes are queued; one is in flight.
/// Heartbeats, all that idle workers say, are taken in by gRPC's thread: waking the stream's for
/// them would be most of what they cost.
class WorkerStream final
    : public grpc::ServerBidiReactor<v1::WorkerMessage, v1::CoordinatorMessage>,
      public WorkerLink,
      public std::enable_shared_from_this<WorkerStream> {
 public:
  explicit WorkerStream(Farm& farm) : farm_(farm) {}

  /// Serves the stream on the calling thread; returns when gRPC is done with it.
  void Run();
  /// Whether Run has returned, or is about to.
  bool Ended() const;

  void Send(ToWorker message) override;
  void Close() override;

 private:
  // Called by gRPC.
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  absl::Status Serve(std::string* worker);
  std::optional<v1::WorkerMessage> TakeMessage();
  bool TakeHeartbeat();
  void Finish(const absl::Status& status);
  void WriteNext() STRATA_REQUIRES(mutex_);
  void FinishLocked(const absl::Status& status) STRATA_REQUIRES(mutex_);

  Farm& farm_;
  mutable Mutex mutex_;
  CondVar changed_;
  v1::WorkerMessage read_;        ///< gRPC's while reading_, the place for one message otherwise.
  v1::CoordinatorMessage write_;  ///< gRPC's while writing_.
  std::string worker_ STRATA_GUARDED_BY(mutex_);  ///< Its id; empty before its hello.
  std::deque<ToWorker> outbox_ STRATA_GUARDED_BY(mutex_);
  bool reading_ STRATA_GUARDED_BY(mutex_) = false;
  bool message_waits_ STRATA_GUARDED_BY(mutex_) = false;
  bool reads_ended_ STRATA_GUARDED_BY(mutex_) = false;
  bool writing_ STRATA_GUARDED_BY(mutex_) = false;
  bool closing_ STRATA_GUARDED_BY(mutex_) = false;
  bool finished_ STRATA_GUARDED_BY(mutex_) = false;  ///< Finish was called.
  bool done_ STRATA_GUARDED_BY(mutex_) = false;      ///< gRPC lets go of the stream.
  bool ended_ STRATA_GUARDED_BY(mutex_) = false;
};

/// The worker service: makes a WorkerStream and its thread for each connection.
class WorkerServiceImpl final : public v1::WorkerService::CallbackService {
 public:
  explicit WorkerServiceImpl(Farm& farm) : farm_(farm) {}
  /// Waits for all streams: shut the gRPC server down before.
  ~WorkerServiceImpl() override;

  grpc::ServerBidiReactor<v1::WorkerMessage, v1::CoordinatorMessage>* Connect(
      grpc::CallbackServerContext* context) override;

 private:
  struct Connection {
    std::shared_ptr<WorkerStream> stream;
    std::thread thread;
  };

  Farm& farm_;
  Mutex mutex_;
  std::list<Connection> connections_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
