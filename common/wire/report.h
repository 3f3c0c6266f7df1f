#pragma once

#include "common/report.h"
#include "strata/v1/client.pb.h"

// What a coordinator tells its clients, as strata.v1 messages and back.

namespace strata::wire {

/// `with_files` false leaves the files of the bundle out.
void ToWire(const JobStatus& status, v1::JobStatus* message, bool with_files);
absl::StatusOr<JobStatus> FromWire(const v1::JobStatus& message);

void ToWire(const WorkerStatus& status, v1::WorkerStatus* message);
WorkerStatus FromWire(const v1::WorkerStatus& message);

void ToWire(const LogLine& line, v1::LogLine* message);
LogLine FromWire(const v1::LogLine& message);

/// All of an image but its values.
void ToWire(const ImageLayers& image, v1::ImageHeader* message);

/// Values in one ImageRows message: 1 MiB of floats.
inline constexpr size_t kImageRowValues = (1 << 20) / sizeof(float);

/// Puts an image together from its header and rows; refuses more values than the header promised.
class ImageReader {
 public:
  absl::Status Add(const v1::FetchImageResponse& message);
  /// The image; DATA_LOSS when values are missing.
  absl::StatusOr<ImageLayers> Finish() &&;

 private:
  bool has_header_ = false;
  size_t expected_ = 0;
  ImageLayers image_;
};

}  // namespace strata::wire
