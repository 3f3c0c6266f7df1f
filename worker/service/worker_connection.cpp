#include "worker/service/worker_connection.h"

#include <utility>

#include "common/wire/status.h"

namespace strata {
namespace {

/// Results wait while so much is queued.
constexpr size_t kQueueBytes = 64 << 20;

size_t BytesOf(const FromWorker& message) {
  const auto* result = std::get_if<UnitResult>(&message);
  return result == nullptr ? 0 : result->partial.values.size() * sizeof(double);
}

}  // namespace

void WorkerConnection::Start(v1::WorkerService::Stub& stub) {
  stub.async()->Connect(&context_, this);
  // Writes are started from other threads than gRPC's; the hold keeps the call until reads end.
  AddHold();
  StartRead(&read_);
  StartCall();
}

void WorkerConnection::Send(FromWorker message) {
  const size_t bytes = BytesOf(message);
  MutexLock lock(mutex_);
  while (bytes > 0 && queued_bytes_ > kQueueBytes && !ended_) changed_.Wait(mutex_);
  if (ended_ || half_closed_) return;
  queue_.push_back({wire::WorkerMessageWriter(std::move(message)), bytes});
  queued_bytes_ += bytes;
  if (!writing_) WriteNext();
}

void WorkerConnection::WriteNext() {
  Queued& front = queue_.front();
  front.writer.Next(&write_);
  if (front.writer.Done()) {
    queued_bytes_ -= front.bytes;
    queue_.pop_front();
    changed_.NotifyAll();
  }
  writing_ = true;
  StartWrite(&write_);
}

void WorkerConnection::Close() {
  MutexLock lock(mutex_);
  closing_ = true;
  HalfCloseIfFlushed();
}

void WorkerConnection::HalfCloseIfFlushed() {
  if (!closing_ || half_closed_ || ended_ || writing_ || !queue_.empty()) return;
  half_closed_ = true;
  StartWritesDone();
}

void WorkerConnection::Cancel() { context_.TryCancel(); }

std::chrono::steady_clock::time_point WorkerConnection::LastWrite() {
  MutexLock lock(mutex_);
  return last_write_;
}

std::optional<absl::Status> WorkerConnection::WaitForEnd(std::chrono::milliseconds period) {
  const auto deadline = std::chrono::steady_clock::now() + period;
  MutexLock lock(mutex_);
  while (!end_ && changed_.WaitUntil(mutex_, deadline)) {
  }
  return end_;
}

void WorkerConnection::OnReadDone(bool ok) {
  if (ok) {
    absl::StatusOr<ToWorker> message = wire::FromWire(read_);
    if (message.ok()) {
      session_.Receive(*std::move(message));
    } else {
      {
        MutexLock lock(mutex_);
        broken_ = message.status();
      }
      context_.TryCancel();
    }
    StartRead(&read_);
    return;
  }
  MutexLock lock(mutex_);
  ended_ = true;
  queue_.clear();
  changed_.NotifyAll();
  RemoveHold();
}

void WorkerConnection::OnWriteDone(bool ok) {
  MutexLock lock(mutex_);
  writing_ = false;
  if (ok) {
    last_write_ = std::chrono::steady_clock::now();
  } else {
    queue_.clear();
  }
  if (ended_) return;
  if (!queue_.empty()) {
    WriteNext();
  } else {
    HalfCloseIfFlushed();
  }
}

void WorkerConnection::OnDone(const grpc::Status& status) {
  MutexLock lock(mutex_);  // Once unlocked, who waits for the end may destroy this.
  end_ = broken_.ok() ? wire::FromGrpc(status) : broken_;
  changed_.NotifyAll();
}

}  // namespace strata
