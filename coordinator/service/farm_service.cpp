#include "coordinator/service/farm_service.h"

#include <utility>

#include "common/wire/field.h"
#include "common/wire/job.h"
#include "common/wire/report.h"
#include "common/wire/status.h"
#include "coordinator/service/transfer_streams.h"
#include "coordinator/service/watch_stream.h"

namespace strata {
namespace {

constexpr int kMaxDigests = 65536;

grpc::ServerUnaryReactor* Answer(grpc::CallbackServerContext* context, const absl::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(wire::ToGrpc(status));
  return reactor;
}

/// For the requests that name a job.
template <class Ask>
grpc::ServerUnaryReactor* AnswerAbout(grpc::CallbackServerContext* context, const JobId& job,
                                      Ask ask) {
  absl::Status status = wire::CheckJobId(job, "job");
  if (status.ok()) status = ask(job);
  return Answer(context, status);
}

/// Ends a server stream at once with an error.
template <class Response>
class RefusedStream final : public grpc::ServerWriteReactor<Response> {
 public:
  explicit RefusedStream(const absl::Status& status) { this->Finish(wire::ToGrpc(status)); }
  void OnDone() override { delete this; }
};

}  // namespace

grpc::ServerReadReactor<v1::UploadFileRequest>* FarmServiceImpl::UploadFile(
    grpc::CallbackServerContext*, v1::UploadFileResponse*) {
  return new UploadStream(farm_);
}

grpc::ServerUnaryReactor* FarmServiceImpl::FindMissingFiles(
    grpc::CallbackServerContext* context, const v1::FindMissingFilesRequest* request,
    v1::FindMissingFilesResponse* response) {
  if (request->digests_size() > kMaxDigests) {
    return Answer(context, wire::FieldError("digests", "at most 65536 are allowed; ask in parts"));
  }
  std::vector<Digest> digests;
  for (const std::string& bytes : request->digests()) {
    absl::StatusOr<Digest> digest = wire::ReadDigest(bytes, "digests");
    if (!digest.ok()) return Answer(context, digest.status());
    digests.push_back(*digest);
  }
  for (const Digest& digest : farm_.MissingFiles(digests)) {
    response->add_missing(wire::DigestBytes(digest));
  }
  return Answer(context, absl::OkStatus());
}

grpc::ServerUnaryReactor* FarmServiceImpl::Submit(grpc::CallbackServerContext* context,
                                                  const v1::SubmitRequest* request,
                                                  v1::SubmitResponse* response) {
  const absl::Status named = wire::CheckText(request->request_id(), 128, true, "request_id");
  if (!named.ok()) return Answer(context, named);
  const absl::StatusOr<JobSpec> spec = wire::FromWire(request->spec());
  if (!spec.ok()) return Answer(context, spec.status());
  absl::StatusOr<JobId> job = farm_.Submit(*spec, request->request_id(), Now());
  if (job.ok()) response->set_job(*std::move(job));
  return Answer(context, job.status());
}

grpc::ServerUnaryReactor* FarmServiceImpl::Get(grpc::CallbackServerContext* context,
                                               const v1::GetRequest* request,
                                               v1::GetResponse* response) {
  return AnswerAbout(context, request->job(), [&](const JobId& job) {
    const absl::StatusOr<JobStatus> status = farm_.Get(job);
    if (status.ok()) wire::ToWire(*status, response->mutable_status(), /*with_files=*/true);
    return status.status();
  });
}

grpc::ServerUnaryReactor* FarmServiceImpl::List(grpc::CallbackServerContext* context,
                                                const v1::ListRequest*,
                                                v1::ListResponse* response) {
  for (const JobStatus& status : farm_.List()) {
    wire::ToWire(status, response->add_jobs(), /*with_files=*/false);
  }
  return Answer(context, absl::OkStatus());
}

grpc::ServerWriteReactor<v1::WatchResponse>* FarmServiceImpl::Watch(
    grpc::CallbackServerContext*, const v1::WatchRequest* request) {
  const absl::Status named = wire::CheckJobId(request->job(), "job");
  if (!named.ok()) return new RefusedStream<v1::WatchResponse>(named);
  return WatchStream::Start(farm_, request->job());
}

grpc::ServerWriteReactor<v1::FetchImageResponse>* FarmServiceImpl::FetchImage(
    grpc::CallbackServerContext*, const v1::FetchImageRequest* request) {
  const absl::Status named = wire::CheckJobId(request->job(), "job");
  if (!named.ok()) return new RefusedStream<v1::FetchImageResponse>(named);
  return new ImageStream(farm_, tasks_, request->job());
}

grpc::ServerUnaryReactor* FarmServiceImpl::Cancel(grpc::CallbackServerContext* context,
                                                  const v1::CancelRequest* request,
                                                  v1::CancelResponse*) {
  return AnswerAbout(context, request->job(),
                     [&](const JobId& job) { return farm_.Cancel(job, Now()); });
}

grpc::ServerUnaryReactor* FarmServiceImpl::Pause(grpc::CallbackServerContext* context,
                                                 const v1::PauseRequest* request,
                                                 v1::PauseResponse*) {
  return AnswerAbout(context, request->job(),
                     [&](const JobId& job) { return farm_.Pause(job, Now()); });
}

grpc::ServerUnaryReactor* FarmServiceImpl::Resume(grpc::CallbackServerContext* context,
                                                  const v1::ResumeRequest* request,
                                                  v1::ResumeResponse*) {
  return AnswerAbout(context, request->job(),
                     [&](const JobId& job) { return farm_.Resume(job, Now()); });
}

grpc::ServerUnaryReactor* FarmServiceImpl::Retry(grpc::CallbackServerContext* context,
                                                 const v1::RetryRequest* request,
                                                 v1::RetryResponse*) {
  return AnswerAbout(context, request->job(),
                     [&](const JobId& job) { return farm_.Retry(job, Now()); });
}

grpc::ServerUnaryReactor* FarmServiceImpl::Delete(grpc::CallbackServerContext* context,
                                                  const v1::DeleteRequest* request,
                                                  v1::DeleteResponse*) {
  return AnswerAbout(context, request->job(), [&](const JobId& job) { return farm_.Delete(job); });
}

grpc::ServerUnaryReactor* FarmServiceImpl::SetPriority(grpc::CallbackServerContext* context,
                                                       const v1::SetPriorityRequest* request,
                                                       v1::SetPriorityResponse*) {
  return AnswerAbout(context, request->job(), [&](const JobId& job) -> absl::Status {
    if (request->priority() < -100 || request->priority() > 100) {
      return wire::FieldError("priority",
                              absl::StrCat("must be -100 to 100, not ", request->priority()));
    }
    return farm_.SetPriority(job, request->priority(), Now());
  });
}

grpc::ServerUnaryReactor* FarmServiceImpl::Logs(grpc::CallbackServerContext* context,
                                                const v1::LogsRequest* request,
                                                v1::LogsResponse* response) {
  return AnswerAbout(context, request->job(), [&](const JobId& job) {
    const absl::StatusOr<std::vector<LogLine>> lines = farm_.Logs(job);
    if (!lines.ok()) return lines.status();
    for (const LogLine& line : *lines) wire::ToWire(line, response->add_lines());
    return absl::OkStatus();
  });
}

grpc::ServerUnaryReactor* FarmServiceImpl::ListWorkers(grpc::CallbackServerContext* context,
                                                       const v1::ListWorkersRequest*,
                                                       v1::ListWorkersResponse* response) {
  for (const WorkerStatus& status : farm_.Workers(Now())) {
    wire::ToWire(status, response->add_workers());
  }
  return Answer(context, absl::OkStatus());
}

}  // namespace strata
