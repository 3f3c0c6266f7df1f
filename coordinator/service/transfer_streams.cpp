#include "coordinator/service/transfer_streams.h"

#include <algorithm>
#include <utility>

#include "common/messages.h"
#include "common/wire/field.h"
#include "common/wire/report.h"
#include "common/wire/status.h"

namespace strata {
namespace {

/// Bytes that are not those announced are the client's mistake, whatever the store calls them; the
/// sentence names the file by its digest and says what is wrong with it.
absl::Status OfUpload(const absl::Status& status) {
  const bool other_bytes = absl::IsOutOfRange(status) || absl::IsDataLoss(status);
  return Annotate(other_bytes ? absl::InvalidArgumentError(status.message()) : status, "data");
}

}  // namespace

UploadStream::UploadStream(Farm& farm) : farm_(farm) { StartRead(&read_); }

void UploadStream::OnReadDone(bool ok) {
  const absl::Status status = ok ? Take(read_) : End();
  if (ok && status.ok()) {
    StartRead(&read_);
  } else {
    Finish(wire::ToGrpc(status));
  }
}

absl::Status UploadStream::Take(const v1::UploadFileRequest& request) {
  if (request.has_header()) {
    if (upload_) return wire::FieldError("header", "must come once");
    STRATA_ASSIGN_OR_RETURN(const Digest digest,
                            wire::ReadDigest(request.header().digest(), "header.digest"));
    STRATA_ASSIGN_OR_RETURN(upload_, farm_.BeginUpload(digest, request.header().bytes()));
    return absl::OkStatus();
  }
  if (!upload_) return wire::FieldError("header", "must come before the data");
  if (request.data().empty() || request.data().size() > kFileChunkBytes) {
    return wire::FieldError("data", "must be 1 byte to 1 MiB");
  }
  return OfUpload(upload_->Append(request.data()));
}

absl::Status UploadStream::End() {
  if (!upload_) return wire::FieldError("header", "is missing");
  return OfUpload(upload_->Finish());
}

ImageStream::ImageStream(Farm& farm, TaskThread& tasks, JobId job) {
  tasks.Post([this, &farm, job = std::move(job)] { Begin(farm.Image(job)); });
}

void ImageStream::Begin(absl::StatusOr<ImageLayers> image) {
  if (!image.ok()) {
    Finish(wire::ToGrpc(image.status()));
    return;
  }
  image_ = *std::move(image);
  wire::ToWire(image_, write_.mutable_header());
  StartWrite(&write_);
}

void ImageStream::OnWriteDone(bool ok) {
  if (!ok || sent_ == image_.values.size()) {
    Finish(ok ? grpc::Status::OK : grpc::Status::CANCELLED);
    return;
  }
  const size_t count = std::min(wire::kImageRowValues, image_.values.size() - sent_);
  const auto begin = image_.values.begin() + static_cast<ptrdiff_t>(sent_);
  auto* values = write_.mutable_rows()->mutable_values();
  values->Clear();
  values->Add(begin, begin + static_cast<ptrdiff_t>(count));
  sent_ += count;
  StartWrite(&write_);
}

}  // namespace strata
