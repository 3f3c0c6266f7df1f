#pragma once

#include <memory>

#include "coordinator/farm.h"
#include "coordinator/service/task_thread.h"
#include "strata/v1/client.grpc.pb.h"

namespace strata {

/// Takes one file. Owned by gRPC.
class UploadStream final : public grpc::ServerReadReactor<v1::UploadFileRequest> {
 public:
  explicit UploadStream(Farm& farm);

 private:
  absl::Status Take(const v1::UploadFileRequest& request);
  absl::Status End();

  // Called by gRPC, one at a time.
  void OnReadDone(bool ok) override;
  void OnDone() override { delete this; }

  Farm& farm_;
  v1::UploadFileRequest read_;
  std::unique_ptr<Farm::FileUpload> upload_;
};

/// Sends one image: computed on `tasks`, then streamed from where it lies. Owned by gRPC.
class ImageStream final : public grpc::ServerWriteReactor<v1::FetchImageResponse> {
 public:
  ImageStream(Farm& farm, TaskThread& tasks, JobId job);

 private:
  void Begin(absl::StatusOr<ImageLayers> image);

  // Called by gRPC, one at a time.
  void OnWriteDone(bool ok) override;
  void OnDone() override { delete this; }

  ImageLayers image_;
  size_t sent_ = 0;  ///< Values.
  v1::FetchImageResponse write_;
};

}  // namespace strata
