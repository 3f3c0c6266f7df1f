#pragma once

#include "coordinator/farm.h"
#include "coordinator/service/task_thread.h"
#include "strata/v1/client.grpc.pb.h"

namespace strata {

/// The client service: checks a request, asks the farm, maps the error.
class FarmServiceImpl final : public v1::FarmService::CallbackService {
 public:
  explicit FarmServiceImpl(Farm& farm) : farm_(farm) {}

  grpc::ServerReadReactor<v1::UploadFileRequest>* UploadFile(grpc::CallbackServerContext*,
                                                             v1::UploadFileResponse*) override;
  grpc::ServerUnaryReactor* FindMissingFiles(grpc::CallbackServerContext*,
                                             const v1::FindMissingFilesRequest*,
                                             v1::FindMissingFilesResponse*) override;
  grpc::ServerUnaryReactor* Submit(grpc::CallbackServerContext*, const v1::SubmitRequest*,
                                   v1::SubmitResponse*) override;
  grpc::ServerUnaryReactor* Get(grpc::CallbackServerContext*, const v1::GetRequest*,
                                v1::GetResponse*) override;
  grpc::ServerUnaryReactor* List(grpc::CallbackServerContext*, const v1::ListRequest*,
                                 v1::ListResponse*) override;
  grpc::ServerWriteReactor<v1::WatchResponse>* Watch(grpc::CallbackServerContext*,
                                                     const v1::WatchRequest*) override;
  grpc::ServerWriteReactor<v1::FetchImageResponse>* FetchImage(
      grpc::CallbackServerContext*, const v1::FetchImageRequest*) override;
  grpc::ServerUnaryReactor* Cancel(grpc::CallbackServerContext*, const v1::CancelRequest*,
                                   v1::CancelResponse*) override;
  grpc::ServerUnaryReactor* Pause(grpc::CallbackServerContext*, const v1::PauseRequest*,
                                  v1::PauseResponse*) override;
  grpc::ServerUnaryReactor* Resume(grpc::CallbackServerContext*, const v1::ResumeRequest*,
                                   v1::ResumeResponse*) override;
  grpc::ServerUnaryReactor* Retry(grpc::CallbackServerContext*, const v1::RetryRequest*,
                                  v1::RetryResponse*) override;
  grpc::ServerUnaryReactor* Delete(grpc::CallbackServerContext*, const v1::DeleteRequest*,
                                   v1::DeleteResponse*) override;
  grpc::ServerUnaryReactor* SetPriority(grpc::CallbackServerContext*, const v1::SetPriorityRequest*,
                                        v1::SetPriorityResponse*) override;
  grpc::ServerUnaryReactor* Logs(grpc::CallbackServerContext*, const v1::LogsRequest*,
                                 v1::LogsResponse*) override;
  grpc::ServerUnaryReactor* ListWorkers(grpc::CallbackServerContext*, const v1::ListWorkersRequest*,
                                        v1::ListWorkersResponse*) override;

 private:
  Farm& farm_;
  TaskThread tasks_;
};

}  // namespace strata
