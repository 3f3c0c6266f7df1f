#include "coordinator/service/watch_stream.h"

#include "common/wire/report.h"
#include "common/wire/status.h"

namespace strata {

grpc::ServerWriteReactor<v1::WatchResponse>* WatchStream::Start(Farm& farm, const JobId& job) {
  std::shared_ptr<WatchStream> stream(new WatchStream(farm));
  stream->self_ = stream;
  stream->Subscribe(job);
  return stream.get();
}

void WatchStream::Subscribe(const JobId& job) {
  const std::shared_ptr<WatchStream> self = shared_from_this();
  const absl::StatusOr<uint64_t> handle =
      farm_.Subscribe(job, [self](const JobStatus& status) { self->OnStatus(status); });
  const absl::StatusOr<JobStatus> now = farm_.Get(job);
  if (handle.ok()) {
    MutexLock lock(mutex_);
    subscription_ = *handle;
  }
  if (now.ok()) {
    OnStatus(*now);
  } else {
    MutexLock lock(mutex_);
    FinishLocked(now.status());
  }
}

void WatchStream::OnStatus(const JobStatus& status) {
  MutexLock lock(mutex_);
  if (last_ || finished_) return;
  last_ = IsFinal(status.state);
  latest_ = status;
  if (!writing_) WriteNext();
}

void WatchStream::WriteNext() {
  write_.Clear();
  wire::ToWire(*latest_, write_.mutable_status(), /*with_files=*/false);
  latest_.reset();
  writing_ = true;
  StartWrite(&write_);
}

void WatchStream::FinishLocked(const absl::Status& status) {
  if (finished_) return;
  finished_ = true;
  Finish(wire::ToGrpc(status));
}

void WatchStream::OnWriteDone(bool ok) {
  MutexLock lock(mutex_);
  writing_ = false;
  if (finished_) return;
  if (!ok) {
    FinishLocked(absl::CancelledError("the client went away"));
  } else if (latest_) {
    WriteNext();
  } else if (last_) {
    FinishLocked(absl::OkStatus());
  }
}

void WatchStream::OnCancel() {
  MutexLock lock(mutex_);
  FinishLocked(absl::CancelledError("the client went away"));
}

void WatchStream::OnDone() {
  const std::shared_ptr<WatchStream> self = std::move(self_);
  std::optional<uint64_t> subscription;
  {
    MutexLock lock(mutex_);
    subscription = subscription_;
  }
  if (subscription) farm_.Unsubscribe(*subscription);
}

}  // namespace strata
