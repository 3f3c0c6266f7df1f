#include "common/wire/worker_messages.h"

#include <utility>

#include "common/wire/field.h"
#include "common/wire/job.h"

namespace strata::wire {
namespace {

constexpr size_t kMaxReasonBytes = 16 << 10;

void Fill(const Hello& hello, v1::WorkerMessage* out) {
  v1::Hello* message = out->mutable_hello();
  message->set_protocol(hello.protocol);
  message->set_build(hello.build);
  message->set_kernel_revision(hello.kernel_revision);
  for (const auto& [name, version] : hello.libraries) {
    (*message->mutable_libraries())[name] = version;
  }
  message->set_isa(hello.isa);
  message->set_traced(DigestBytes(hello.traced));
  message->set_name(hello.name);
  for (const std::string& tag : hello.tags) message->add_tags(tag);
  message->set_threads(hello.threads);
  message->set_memory_limit(hello.memory_limit);
}

void Fill(const Heartbeat&, v1::WorkerMessage* out) { out->mutable_heartbeat(); }

void Fill(const FileRequest& request, v1::WorkerMessage* out) {
  out->mutable_file_request()->set_digest(DigestBytes(request.digest));
  out->mutable_file_request()->set_offset(request.offset);
}

void Fill(const UnitResult&, v1::WorkerMessage*) {}  // Goes through PartialChunker.

void Fill(const UnitFailure& failure, v1::WorkerMessage* out) {
  v1::UnitFailure* message = out->mutable_failure();
  message->set_job(failure.job);
  message->set_lease(failure.lease);
  message->mutable_unit()->set_round(failure.unit.round);
  message->mutable_unit()->set_tile(failure.unit.tile);
  message->mutable_unit()->set_piece(failure.unit.piece);
  message->set_reason(failure.reason.substr(0, kMaxReasonBytes));
  if (failure.replay.size() <= kMaxCommandBytes) message->set_replay(failure.replay);
  message->set_job_wide(failure.job_wide);
}

void Fill(const Draining&, v1::WorkerMessage* out) { out->mutable_draining(); }

absl::StatusOr<FromWorker> Read(const v1::Hello& message) {
  Hello hello;
  hello.protocol = message.protocol();
  if (hello.protocol != kProtocol) return hello;
  STRATA_RETURN_IF_ERROR(CheckText(message.build(), 256, true, "hello.build"));
  STRATA_RETURN_IF_ERROR(CheckText(message.isa(), 64, false, "hello.isa"));
  STRATA_RETURN_IF_ERROR(CheckText(message.name(), 256, false, "hello.name"));
  if (message.libraries_size() > 64) return FieldError("hello.libraries", "at most 64 are allowed");
  for (const auto& [name, version] : message.libraries()) {
    STRATA_RETURN_IF_ERROR(CheckText(name, 64, true, "hello.libraries"));
    STRATA_RETURN_IF_ERROR(CheckText(version, 256, false, "hello.libraries"));
    hello.libraries[name] = version;
  }
  if (message.tags_size() > 64) return FieldError("hello.tags", "at most 64 are allowed");
  for (const std::string& tag : message.tags()) {
    STRATA_RETURN_IF_ERROR(CheckText(tag, 64, true, "hello.tags"));
    hello.tags.push_back(tag);
  }
  if (message.threads() < 1 || message.threads() > 4096) {
    return FieldError("hello.threads", "must be 1 to 4096");
  }
  STRATA_ASSIGN_OR_RETURN(hello.traced, ReadDigest(message.traced(), "hello.traced"));
  hello.build = message.build();
  hello.kernel_revision = message.kernel_revision();
  hello.isa = message.isa();
  hello.name = message.name();
  hello.threads = message.threads();
  hello.memory_limit = message.memory_limit();
  return hello;
}

absl::StatusOr<FromWorker> Read(const v1::FileRequest& message) {
  STRATA_ASSIGN_OR_RETURN(const Digest digest, ReadDigest(message.digest(), "file_request.digest"));
  return FileRequest{digest, message.offset()};
}

absl::StatusOr<FromWorker> Read(const v1::UnitFailure& message) {
  STRATA_RETURN_IF_ERROR(CheckJobId(message.job(), "failure.job"));
  STRATA_RETURN_IF_ERROR(CheckText(message.reason(), kMaxReasonBytes, true, "failure.reason"));
  STRATA_RETURN_IF_ERROR(CheckText(message.replay(), kMaxCommandBytes, false, "failure.replay"));
  const v1::UnitId& unit = message.unit();
  return UnitFailure{message.job(),    message.lease(),  {unit.round(), unit.tile(), unit.piece()},
                     message.reason(), message.replay(), message.job_wide()};
}

void Fill(const Welcome& welcome, v1::CoordinatorMessage* out) {
  out->mutable_welcome()->set_worker(welcome.worker);
  out->mutable_welcome()->set_heartbeat_ms(welcome.heartbeat_ms);
  out->mutable_welcome()->set_silence_ms(welcome.silence_ms);
}

void Fill(const Refusal& refusal, v1::CoordinatorMessage* out) {
  out->mutable_refusal()->set_reason(refusal.reason);
  out->mutable_refusal()->set_retry(refusal.retry);
}

void Fill(const JobDescription& job, v1::CoordinatorMessage* out) {
  out->mutable_job()->set_job(job.job);
  ToWire(job.spec, out->mutable_job()->mutable_spec());
}

void Fill(const Lease& lease, v1::CoordinatorMessage* out) {
  v1::Lease* message = out->mutable_lease();
  message->set_job(lease.job);
  message->set_lease(lease.lease);
  for (const WorkUnit& unit : lease.units) {
    v1::WorkUnit* wire_unit = message->add_units();
    wire_unit->mutable_id()->set_round(unit.id.round);
    wire_unit->mutable_id()->set_tile(unit.id.tile);
    wire_unit->mutable_id()->set_piece(unit.id.piece);
    ToWire(unit.pixels, wire_unit->mutable_pixels());
    for (const SampleRange& range : unit.ranges) {
      wire_unit->add_range_begin(range.begin);
      wire_unit->add_range_end(range.end);
    }
  }
}

void Fill(const CancelJob& cancel, v1::CoordinatorMessage* out) {
  out->mutable_cancel_job()->set_job(cancel.job);
}

void Fill(const CancelLease& cancel, v1::CoordinatorMessage* out) {
  out->mutable_cancel_lease()->set_lease(cancel.lease);
}

void Fill(const FileChunk& chunk, v1::CoordinatorMessage* out) {
  v1::FileChunk* message = out->mutable_file_chunk();
  message->set_digest(DigestBytes(chunk.digest));
  message->set_offset(chunk.offset);
  message->set_total(chunk.total);
  message->set_data(chunk.data);
  message->set_error(chunk.error);
}

void Fill(const Drain&, v1::CoordinatorMessage* out) { out->mutable_drain(); }

absl::StatusOr<WorkUnit> Read(const v1::WorkUnit& message) {
  WorkUnit unit;
  unit.id = {message.id().round(), message.id().tile(), message.id().piece()};
  unit.pixels = FromWire(message.pixels());
  const PixelRect& rect = unit.pixels;
  if (rect.x0 < 0 || rect.y0 < 0 || rect.x1 > 65536 || rect.y1 > 65536 || rect.x1 <= rect.x0 ||
      rect.y1 <= rect.y0 || rect.Width() > kMaxTile || rect.Height() > kMaxTile) {
    return FieldError("lease.units.pixels", "must be a rectangle of 1 to 1024 x 1024 pixels");
  }
  const int ranges = message.range_begin_size();
  if (ranges != message.range_end_size() || (ranges != 1 && ranges != rect.Pixels())) {
    return FieldError("lease.units.range_begin", "must hold one number, or one for each pixel");
  }
  unit.ranges.reserve(static_cast<size_t>(ranges));
  for (int i = 0; i < ranges; ++i) {
    const SampleRange range{message.range_begin(i), message.range_end(i)};
    if (range.end < range.begin) {
      return FieldError("lease.units.range_end", "must not be below range_begin");
    }
    unit.ranges.push_back(range);
  }
  return unit;
}

absl::StatusOr<ToWorker> Read(const v1::JobDescription& message) {
  STRATA_RETURN_IF_ERROR(CheckJobId(message.job(), "job.job"));
  STRATA_ASSIGN_OR_RETURN(JobSpec spec, FromWire(message.spec()));
  STRATA_RETURN_IF_ERROR(ValidateJobSpec(spec));
  return JobDescription{message.job(), std::move(spec)};
}

absl::StatusOr<ToWorker> Read(const v1::Lease& message) {
  STRATA_RETURN_IF_ERROR(CheckJobId(message.job(), "lease.job"));
  if (message.units().empty()) return FieldError("lease.units", "must not be empty");
  Lease lease{message.job(), message.lease(), {}};
  lease.units.reserve(static_cast<size_t>(message.units_size()));
  for (const v1::WorkUnit& unit : message.units()) {
    STRATA_ASSIGN_OR_RETURN(WorkUnit plain, Read(unit));
    lease.units.push_back(std::move(plain));
  }
  return lease;
}

absl::StatusOr<ToWorker> Read(const v1::FileChunk& message) {
  STRATA_ASSIGN_OR_RETURN(const Digest digest, ReadDigest(message.digest(), "file_chunk.digest"));
  if (message.data().size() > kFileChunkBytes) {
    return FieldError("file_chunk.data", "at most 1 MiB is allowed");
  }
  if (message.offset() > message.total() ||
      message.data().size() > message.total() - message.offset()) {
    return FieldError("file_chunk.offset", "leads beyond the end of the file");
  }
  return FileChunk{digest, message.offset(), message.total(), message.data(), message.error()};
}

}  // namespace

WorkerMessageWriter::WorkerMessageWriter(FromWorker message) : message_(std::move(message)) {
  if (auto* result = std::get_if<UnitResult>(&message_)) chunker_.emplace(std::move(*result));
}

void WorkerMessageWriter::Next(v1::WorkerMessage* out) {
  if (chunker_) {
    chunker_->Next(out->mutable_partial());
    return;
  }
  out->Clear();
  std::visit([out](const auto& message) { Fill(message, out); }, message_);
  done_ = true;
}

absl::StatusOr<std::optional<FromWorker>> WorkerMessageReader::Add(
    const v1::WorkerMessage& message) {
  switch (message.message_case()) {
    case v1::WorkerMessage::kHello:
      return Read(message.hello());
    case v1::WorkerMessage::kHeartbeat:
      return FromWorker(Heartbeat{});
    case v1::WorkerMessage::kFileRequest:
      return Read(message.file_request());
    case v1::WorkerMessage::kPartial: {
      STRATA_ASSIGN_OR_RETURN(std::optional<UnitResult> result, assembler_.Add(message.partial()));
      if (!result) return std::nullopt;
      return FromWorker(*std::move(result));
    }
    case v1::WorkerMessage::kFailure:
      return Read(message.failure());
    case v1::WorkerMessage::kDraining:
      return FromWorker(Draining{});
    case v1::WorkerMessage::MESSAGE_NOT_SET:
      break;
  }
  return FieldError("message", "is empty or of a kind this coordinator does not know");
}

void ToWire(const ToWorker& message, v1::CoordinatorMessage* out) {
  out->Clear();
  std::visit([out](const auto& alternative) { Fill(alternative, out); }, message);
}

absl::StatusOr<ToWorker> FromWire(const v1::CoordinatorMessage& message) {
  switch (message.message_case()) {
    case v1::CoordinatorMessage::kWelcome:
      return Welcome{message.welcome().worker(), message.welcome().heartbeat_ms(),
                     message.welcome().silence_ms()};
    case v1::CoordinatorMessage::kRefusal:
      return Refusal{message.refusal().reason(), message.refusal().retry()};
    case v1::CoordinatorMessage::kJob:
      return Read(message.job());
    case v1::CoordinatorMessage::kLease:
      return Read(message.lease());
    case v1::CoordinatorMessage::kCancelJob:
      return CancelJob{message.cancel_job().job()};
    case v1::CoordinatorMessage::kCancelLease:
      return CancelLease{message.cancel_lease().lease()};
    case v1::CoordinatorMessage::kFileChunk:
      return Read(message.file_chunk());
    case v1::CoordinatorMessage::kDrain:
      return Drain{};
    case v1::CoordinatorMessage::MESSAGE_NOT_SET:
      break;
  }
  return FieldError("message", "is empty or of a kind this worker does not know");
}

}  // namespace strata::wire
