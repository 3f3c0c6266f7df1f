#include "coordinator/service/worker_stream.h"

#include <spdlog/spdlog.h>

#include <utility>

#include "common/wire/status.h"
#include "common/wire/worker_messages.h"

namespace strata {
namespace {

/// While so many messages wait to be written, nothing is read: a worker that asks for files and
/// does not take them cannot make the queue grow.
constexpr size_t kOutboxLimit = 64;

}  // namespace

void WorkerStream::Run() {
  std::string worker;
  const absl::Status status = Serve(&worker);
  if (!worker.empty()) farm_.Disconnect(worker, Now());
  if (!status.ok()) spdlog::warn("worker {}: {}", worker, std::string(status.message()));
  Finish(status);
  MutexLock lock(mutex_);
  while (!done_) changed_.Wait(mutex_);
  ended_ = true;
}

absl::Status WorkerStream::Serve(std::string* worker) {
  wire::WorkerMessageReader reader;
  while (std::optional<v1::WorkerMessage> message = TakeMessage()) {
    STRATA_ASSIGN_OR_RETURN(std::optional<FromWorker> received, reader.Add(*message));
    const Hello* hello = received ? std::get_if<Hello>(&*received) : nullptr;
    if ((hello != nullptr) != worker->empty()) {
      return absl::InvalidArgumentError("hello: must come first and once");
    }
    if (hello != nullptr) {
      *worker = farm_.Connect(*hello, shared_from_this(), Now());
      MutexLock lock(mutex_);
      worker_ = *worker;
    } else {
      // A chunk that does not complete its partial still tells that the worker lives.
      farm_.Receive(*worker, received ? *std::move(received) : Heartbeat{}, Now());
    }
  }
  return absl::OkStatus();
}

std::optional<v1::WorkerMessage> WorkerStream::TakeMessage() {
  MutexLock lock(mutex_);
  while (!message_waits_ && !reads_ended_) {
    if (!reading_ && !finished_ && outbox_.size() < kOutboxLimit) {
      reading_ = true;
      StartRead(&read_);
    }
    if (!reading_ && finished_) return std::nullopt;
    changed_.Wait(mutex_);
  }
  if (!message_waits_) return std::nullopt;
  message_waits_ = false;
  v1::WorkerMessage message = std::exchange(read_, {});
  if (!finished_ && outbox_.size() < kOutboxLimit) {
    // The next message comes over the network while this one is merged.
    reading_ = true;
    StartRead(&read_);
  }
  return message;
}

void WorkerStream::Send(ToWorker message) {
  MutexLock lock(mutex_);
  if (finished_ || closing_) return;
  outbox_.push_back(std::move(message));
  if (!writing_) WriteNext();
}

void WorkerStream::Close() {
  MutexLock lock(mutex_);
  closing_ = true;
  if (!writing_) FinishLocked(absl::OkStatus());
}

void WorkerStream::WriteNext() {
  wire::ToWire(outbox_.front(), &write_);
  outbox_.pop_front();
  writing_ = true;
  StartWrite(&write_);
}

void WorkerStream::Finish(const absl::Status& status) {
  MutexLock lock(mutex_);
  FinishLocked(status);
}

void WorkerStream::FinishLocked(const absl::Status& status) {
  if (finished_) return;
  finished_ = true;
  outbox_.clear();
  grpc::ServerBidiReactor<v1::WorkerMessage, v1::CoordinatorMessage>::Finish(wire::ToGrpc(status));
  changed_.NotifyAll();
}

bool WorkerStream::Ended() const {
  MutexLock lock(mutex_);
  return ended_;
}

/// Whether the message just read was a heartbeat, and is done with.
bool WorkerStream::TakeHeartbeat() {
  if (!read_.has_heartbeat()) return false;
  std::string worker;
  {
    MutexLock lock(mutex_);
    if (worker_.empty() || finished_ || outbox_.size() >= kOutboxLimit) return false;
    worker = worker_;
  }
  // Unlocked, since the farm may send. Still counted as reading, so nobody else touches read_.
  farm_.Receive(worker, Heartbeat{}, Now());
  MutexLock lock(mutex_);
  if (finished_) {
    reading_ = false;
    changed_.NotifyAll();
  } else {
    StartRead(&read_);
  }
  return true;
}

void WorkerStream::OnReadDone(bool ok) {
  if (ok && TakeHeartbeat()) return;
  MutexLock lock(mutex_);
  reading_ = false;
  (ok ? message_waits_ : reads_ended_) = true;
  changed_.NotifyAll();
}

void WorkerStream::OnWriteDone(bool ok) {
  MutexLock lock(mutex_);
  writing_ = false;
  if (finished_) return;
  if (!ok) {
    outbox_.clear();
    reads_ended_ = true;
  } else if (!outbox_.empty()) {
    WriteNext();
  } else if (closing_) {
    FinishLocked(absl::OkStatus());
  }
  changed_.NotifyAll();
}

void WorkerStream::OnCancel() {
  MutexLock lock(mutex_);
  reads_ended_ = true;
  changed_.NotifyAll();
}

void WorkerStream::OnDone() {
  const std::shared_ptr<WorkerStream> self = shared_from_this();  // Run ends with done_.
  MutexLock lock(mutex_);
  done_ = true;
  changed_.NotifyAll();
}

WorkerServiceImpl::~WorkerServiceImpl() {
  for (Connection& connection : connections_) connection.thread.join();
}

grpc::ServerBidiReactor<v1::WorkerMessage, v1::CoordinatorMessage>* WorkerServiceImpl::Connect(
    grpc::CallbackServerContext*) {
  MutexLock lock(mutex_);
  for (auto it = connections_.begin(); it != connections_.end();) {
    if (it->stream->Ended()) {
      it->thread.join();
      it = connections_.erase(it);
    } else {
      ++it;
    }
  }
  auto stream = std::make_shared<WorkerStream>(farm_);
  connections_.push_back({stream, std::thread([stream] { stream->Run(); })});
  return stream.get();
}

}  // namespace strata
