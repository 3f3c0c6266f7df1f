#include "cli/farm_client.h"

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <algorithm>
#include <fstream>
#include <utility>

#include "common/messages.h"
#include "common/wire/channel.h"
#include "common/wire/field.h"
#include "common/wire/job.h"
#include "common/wire/report.h"
#include "common/wire/status.h"
#include "grpc/health/v1/health.grpc.pb.h"
#include "strata/v1/client.grpc.pb.h"

namespace strata {
namespace {

constexpr auto kConnectDeadline = std::chrono::seconds(5);
/// For an answer once connected: a submit may have to plan a large frame.
constexpr auto kAnswerDeadline = std::chrono::seconds(30);
constexpr size_t kDigestsInRequest = 4096;

using DeadlineClock = std::chrono::system_clock;  // gRPC's.

}  // namespace

struct FarmClient::State {
  std::string server;  ///< Empty: in this process, always connected.
  std::shared_ptr<grpc::Channel> channel;
  std::unique_ptr<v1::FarmService::Stub> stub;

  absl::Status Connect() const {
    if (server.empty() || channel->WaitForConnected(DeadlineClock::now() + kConnectDeadline)) {
      return absl::OkStatus();
    }
    return absl::UnavailableError(absl::StrCat(server,
                                               ": no coordinator answers there; start one with "
                                               "`strata-coordinator --listen ",
                                               server,
                                               " --state DIR`, or name another with --server"));
  }

  /// One question, one answer.
  template <class Request, class Response>
  absl::Status Ask(grpc::Status (v1::FarmService::Stub::*method)(grpc::ClientContext*,
                                                                 const Request&, Response*),
                   const Request& request, Response* response) const {
    STRATA_RETURN_IF_ERROR(Connect());
    grpc::ClientContext context;
    context.set_deadline(DeadlineClock::now() + kAnswerDeadline);
    const absl::Status status = wire::FromGrpc((stub.get()->*method)(&context, request, response));
    if (!absl::IsDeadlineExceeded(status)) return status;
    return absl::UnavailableError(absl::StrCat(server, ": no answer within 30 s; try again"));
  }

  /// For the requests that are a job id.
  template <class Request, class Response>
  absl::Status AskAbout(grpc::Status (v1::FarmService::Stub::*method)(grpc::ClientContext*,
                                                                      const Request&, Response*),
                        const JobId& job, Response* response) const {
    Request request;
    request.set_job(job);
    return Ask(method, request, response);
  }

  absl::StatusOr<std::vector<const BundleFile*>> Missing(const Bundle& bundle) const;
  absl::Status UploadFile(const BundleFile& file, const std::filesystem::path& path,
                          const std::function<void(uint64_t bytes)>& sent) const;
};

FarmClient::FarmClient(std::unique_ptr<State> state) : state_(std::move(state)) {}
FarmClient::~FarmClient() = default;

absl::StatusOr<std::unique_ptr<FarmClient>> FarmClient::Dial(const std::string& server,
                                                             bool insecure) {
  STRATA_ASSIGN_OR_RETURN(std::shared_ptr<grpc::Channel> channel, wire::Dial(server, insecure));
  std::unique_ptr<FarmClient> client = Over(std::move(channel));
  client->state_->server = server;
  return client;
}

std::unique_ptr<FarmClient> FarmClient::Over(std::shared_ptr<grpc::Channel> channel) {
  auto state = std::make_unique<State>();
  state->stub = v1::FarmService::NewStub(channel);
  state->channel = std::move(channel);
  return std::unique_ptr<FarmClient>(new FarmClient(std::move(state)));
}

absl::StatusOr<std::vector<const BundleFile*>> FarmClient::State::Missing(
    const Bundle& bundle) const {
  std::vector<const BundleFile*> files;  // Each content once.
  for (const BundleFile& file : bundle.files) files.push_back(&file);
  const auto by_digest = [](const BundleFile* a, const BundleFile* b) {
    return a->digest < b->digest;
  };
  std::sort(files.begin(), files.end(), by_digest);
  files.erase(std::unique(files.begin(), files.end(),
                          [](const auto* a, const auto* b) { return a->digest == b->digest; }),
              files.end());
  std::vector<const BundleFile*> missing;
  for (size_t begin = 0; begin < files.size(); begin += kDigestsInRequest) {
    v1::FindMissingFilesRequest request;
    const size_t end = std::min(begin + kDigestsInRequest, files.size());
    for (size_t i = begin; i < end; ++i) {
      request.add_digests(wire::DigestBytes(files[i]->digest));
    }
    v1::FindMissingFilesResponse response;
    STRATA_RETURN_IF_ERROR(Ask(&v1::FarmService::Stub::FindMissingFiles, request, &response));
    for (const std::string& bytes : response.missing()) {
      STRATA_ASSIGN_OR_RETURN(const Digest digest, wire::ReadDigest(bytes, "missing"));
      const BundleFile key{{}, digest, 0};
      const auto found = std::lower_bound(files.begin(), files.end(), &key, by_digest);
      if (found != files.end() && (*found)->digest == digest) missing.push_back(*found);
    }
  }
  return missing;
}

absl::Status FarmClient::State::UploadFile(const BundleFile& file,
                                           const std::filesystem::path& path,
                                           const std::function<void(uint64_t)>& sent) const {
  std::ifstream input(path, std::ios::binary);
  if (!input) return absl::NotFoundError(absl::StrCat(path.string(), ": cannot be opened"));
  grpc::ClientContext context;
  v1::UploadFileResponse response;
  const auto writer = stub->UploadFile(&context, &response);
  v1::UploadFileRequest request;
  request.mutable_header()->set_digest(wire::DigestBytes(file.digest));
  request.mutable_header()->set_bytes(file.bytes);
  bool open = writer->Write(request);
  std::string block;
  while (open) {
    block.resize(kFileChunkBytes);
    input.read(block.data(), static_cast<std::streamsize>(block.size()));
    block.resize(static_cast<size_t>(input.gcount()));
    if (block.empty()) break;
    const uint64_t bytes = block.size();
    request.set_data(std::move(block));
    open = writer->Write(request);
    if (open) sent(bytes);
  }
  writer->WritesDone();
  return Annotate(wire::FromGrpc(writer->Finish()), path.string());
}

absl::Status FarmClient::Upload(const Bundle& bundle, const std::filesystem::path& root,
                                const std::function<void(uint64_t sent, uint64_t total)>& progress,
                                const FilesElsewhere& elsewhere) {
  STRATA_ASSIGN_OR_RETURN(const std::vector<const BundleFile*> missing, state_->Missing(bundle));
  uint64_t total = 0, done = 0;
  for (const BundleFile* file : missing) total += file->bytes;
  for (const BundleFile* file : missing) {
    const auto found = elsewhere.find(file->path);
    const std::filesystem::path path = found == elsewhere.end() ? root / file->path : found->second;
    STRATA_RETURN_IF_ERROR(state_->UploadFile(*file, path, [&](uint64_t bytes) {
      done += bytes;
      if (progress) progress(done, total);
    }));
  }
  return absl::OkStatus();
}

absl::StatusOr<JobId> FarmClient::Submit(const JobSpec& spec, const std::string& request_id) {
  v1::SubmitRequest request;
  wire::ToWire(spec, request.mutable_spec());
  request.set_request_id(request_id);
  v1::SubmitResponse response;
  STRATA_RETURN_IF_ERROR(state_->Ask(&v1::FarmService::Stub::Submit, request, &response));
  return response.job();
}

absl::StatusOr<JobStatus> FarmClient::Get(const JobId& job) {
  v1::GetResponse response;
  STRATA_RETURN_IF_ERROR(state_->AskAbout(&v1::FarmService::Stub::Get, job, &response));
  return wire::FromWire(response.status());
}

absl::StatusOr<std::vector<JobStatus>> FarmClient::List() {
  v1::ListResponse response;
  STRATA_RETURN_IF_ERROR(state_->Ask(&v1::FarmService::Stub::List, v1::ListRequest(), &response));
  std::vector<JobStatus> jobs;
  for (const v1::JobStatus& message : response.jobs()) {
    STRATA_ASSIGN_OR_RETURN(JobStatus status, wire::FromWire(message));
    jobs.push_back(std::move(status));
  }
  return jobs;
}

absl::Status FarmClient::Watch(const JobId& job,
                               const std::function<bool(const JobStatus&)>& on_status) {
  STRATA_RETURN_IF_ERROR(state_->Connect());
  grpc::ClientContext context;
  v1::WatchRequest request;
  request.set_job(job);
  const auto reader = state_->stub->Watch(&context, request);
  v1::WatchResponse response;
  while (reader->Read(&response)) {
    STRATA_ASSIGN_OR_RETURN(const JobStatus status, wire::FromWire(response.status()));
    if (!on_status(status)) {
      context.TryCancel();
      reader->Finish();
      return absl::OkStatus();
    }
  }
  return wire::FromGrpc(reader->Finish());
}

absl::StatusOr<ImageLayers> FarmClient::FetchImage(const JobId& job) {
  STRATA_RETURN_IF_ERROR(state_->Connect());
  grpc::ClientContext context;
  v1::FetchImageRequest request;
  request.set_job(job);
  const auto reader = state_->stub->FetchImage(&context, request);
  v1::FetchImageResponse response;
  wire::ImageReader image;
  absl::Status malformed;
  while (malformed.ok() && reader->Read(&response)) malformed = image.Add(response);
  if (!malformed.ok()) context.TryCancel();
  const absl::Status status = wire::FromGrpc(reader->Finish());
  STRATA_RETURN_IF_ERROR(malformed);
  STRATA_RETURN_IF_ERROR(status);
  return std::move(image).Finish();
}

absl::Status FarmClient::Cancel(const JobId& job) {
  v1::CancelResponse response;
  return state_->AskAbout(&v1::FarmService::Stub::Cancel, job, &response);
}

absl::Status FarmClient::Pause(const JobId& job) {
  v1::PauseResponse response;
  return state_->AskAbout(&v1::FarmService::Stub::Pause, job, &response);
}

absl::Status FarmClient::Resume(const JobId& job) {
  v1::ResumeResponse response;
  return state_->AskAbout(&v1::FarmService::Stub::Resume, job, &response);
}

absl::Status FarmClient::Retry(const JobId& job) {
  v1::RetryResponse response;
  return state_->AskAbout(&v1::FarmService::Stub::Retry, job, &response);
}

absl::Status FarmClient::Delete(const JobId& job) {
  v1::DeleteResponse response;
  return state_->AskAbout(&v1::FarmService::Stub::Delete, job, &response);
}

absl::Status FarmClient::SetPriority(const JobId& job, int priority) {
  v1::SetPriorityRequest request;
  request.set_job(job);
  request.set_priority(priority);
  v1::SetPriorityResponse response;
  return state_->Ask(&v1::FarmService::Stub::SetPriority, request, &response);
}

absl::StatusOr<std::vector<LogLine>> FarmClient::Logs(const JobId& job) {
  v1::LogsResponse response;
  STRATA_RETURN_IF_ERROR(state_->AskAbout(&v1::FarmService::Stub::Logs, job, &response));
  std::vector<LogLine> lines;
  for (const v1::LogLine& line : response.lines()) lines.push_back(wire::FromWire(line));
  return lines;
}

absl::StatusOr<std::vector<WorkerStatus>> FarmClient::Workers() {
  v1::ListWorkersResponse response;
  STRATA_RETURN_IF_ERROR(
      state_->Ask(&v1::FarmService::Stub::ListWorkers, v1::ListWorkersRequest(), &response));
  std::vector<WorkerStatus> workers;
  for (const v1::WorkerStatus& worker : response.workers()) {
    workers.push_back(wire::FromWire(worker));
  }
  return workers;
}

absl::Status FarmClient::Health() {
  STRATA_RETURN_IF_ERROR(state_->Connect());
  grpc::ClientContext context;
  context.set_deadline(DeadlineClock::now() + kConnectDeadline);
  grpc::health::v1::HealthCheckResponse response;
  const auto stub = grpc::health::v1::Health::NewStub(state_->channel);
  const absl::Status status =
      wire::FromGrpc(stub->Check(&context, grpc::health::v1::HealthCheckRequest(), &response));
  if (status.ok() && response.status() == grpc::health::v1::HealthCheckResponse::SERVING) {
    return absl::OkStatus();
  }
  return absl::UnavailableError(absl::StrCat(state_->server, ": the coordinator is not serving",
                                             status.ok() ? "" : ": ", status.message()));
}

}  // namespace strata
