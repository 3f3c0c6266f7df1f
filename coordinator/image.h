#pragma once

#include <string>
#include <utility>
#include <vector>

#include "common/report.h"
#include "coordinator/estimate.h"

namespace strata {

/// Layers of a picture to be filled rectangle by rectangle; see ImageLayers.
class ImageBuilder {
 public:
  /// Intervals are `widening` times those of the estimates.
  ImageBuilder(const JobSpec& spec, double widening);

  /// Sets the pixels of input.wanted. `plain` holds the plain means of each of them, row-major.
  void Fill(const EstimateInput& input, const std::vector<double>& plain);

  ImageLayers Finish(std::vector<std::pair<std::string, std::string>> metadata);

 private:
  ImageLayers image_;
  double widening_;
  bool claims_interval_;
  size_t plain_ = 0;
};

/// The plain means of each pixel of a rectangle, row-major.
std::vector<double> GatherPlain(const Film& film, const PixelRect& wanted);

/// What the picture's header says: job spec, seed, frame, scene digest, build, counts, and the
/// result's digest when the job is done.
std::vector<std::pair<std::string, std::string>> ImageMetadata(const JobStatus& status,
                                                               const std::string& build);

}  // namespace strata
