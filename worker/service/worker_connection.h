#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <optional>

#include "common/sync.h"
#include "common/wire/worker_messages.h"
#include "strata/v1/worker.grpc.pb.h"
#include "worker/session/worker_session.h"

namespace strata {

/// One connection to the coordinator. Messages wait in a queue, one write is in flight; a partial
/// is cut into chunks as they are written. Results wait in Send while the queue is long, so that a
/// slow network holds up rendering and not memory; other messages are small and never wait.
class WorkerConnection final
    : public grpc::ClientBidiReactor<v1::WorkerMessage, v1::CoordinatorMessage>,
      public CoordinatorLink {
 public:
  explicit WorkerConnection(WorkerSession& session) : session_(session) {}

  /// Dials; `stub` outlives the connection. Who starts it keeps it until WaitForEnd has told the
  /// end, and then lets it go on a thread of its own: the call holds the channel, and gRPC's thread
  /// would wait for itself if the channel's last holder went there.
  void Start(v1::WorkerService::Stub& stub);
  void Send(FromWorker message) override;
  /// Ends the connection once what is queued is written.
  void Close();
  /// Ends the connection now.
  void Cancel();
  /// When a write last went out; the clock's beginning before the first.
  std::chrono::steady_clock::time_point LastWrite();
  /// Why the connection ended; nothing when it still stands after `period`.
  std::optional<absl::Status> WaitForEnd(std::chrono::milliseconds period);

 private:
  // Called by gRPC.
  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

  void WriteNext() STRATA_REQUIRES(mutex_);
  void HalfCloseIfFlushed() STRATA_REQUIRES(mutex_);

  struct Queued {
    wire::WorkerMessageWriter writer;
    size_t bytes = 0;
  };

  WorkerSession& session_;
  grpc::ClientContext context_;
  v1::CoordinatorMessage read_;  ///< gRPC's while a read is armed.
  v1::WorkerMessage write_;      ///< gRPC's while writing_.
  Mutex mutex_;
  CondVar changed_;
  std::deque<Queued> queue_ STRATA_GUARDED_BY(mutex_);
  size_t queued_bytes_ STRATA_GUARDED_BY(mutex_) = 0;
  std::chrono::steady_clock::time_point last_write_ STRATA_GUARDED_BY(mutex_);
  bool writing_ STRATA_GUARDED_BY(mutex_) = false;
  bool closing_ STRATA_GUARDED_BY(mutex_) = false;
  bool half_closed_ STRATA_GUARDED_BY(mutex_) = false;
  bool ended_ STRATA_GUARDED_BY(mutex_) = false;   ///< Nothing more may be started.
  absl::Status broken_ STRATA_GUARDED_BY(mutex_);  ///< A message of the peer was malformed.
  std::optional<absl::Status> end_ STRATA_GUARDED_BY(mutex_);
};

}  // namespace strata
