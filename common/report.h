#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/digest.h"
#include "common/job.h"

// What a coordinator tells its clients about jobs and workers.

namespace strata {

enum class JobState { kQueued, kRunning, kPaused, kDone, kFailed, kCancelled };
std::string_view ToString(JobState state);
inline bool IsFinal(JobState s) {
  return s == JobState::kDone || s == JobState::kFailed || s == JobState::kCancelled;
}

/// Relative error of one tile: see JobStatus::rel_error; for the list of the worst.
struct TileError {
  PixelRect pixels;
  double rel_error = 0;
};

/// A job as it stands. Times are seconds; counts include merged work alone.
struct JobStatus {
  JobId id;
  JobSpec spec;
  JobState state = JobState::kQueued;
  std::string message;   ///< Why it failed or waits; empty otherwise.
  double fraction = 0;   ///< How much of the job is done, 0 to 1: an estimate until it ends.
  uint64_t samples = 0;  ///< Merged samples; duplicates not counted.
  uint64_t rays = 0;
  uint64_t nonfinite = 0;
  double spp_mean = 0;  ///< Over the crop.
  uint32_t rounds = 0;  ///< Rounds that are wholly merged.
  /// 99th percentile over pixels and channels of the half-width over max(luminance, 5 % of the
  /// image mean luminance); 0 until every pixel has samples in all replicates. Until the job ends
  /// the half-widths are those that hold at all times, however often one looks. 0 where the
  /// sampler claims no interval.
  double rel_error = 0;
  double flagged = 0;  ///< Share of pixels with a flag, 0 to 1.
  double mean_rgb[3] = {0, 0, 0};
  double samples_per_second = 0;  ///< Over the last few seconds.
  double eta_s = -1;              ///< Estimated seconds left; negative: unknown.
  double eta_low_s = -1;          ///< The time left is between these in about 90 % of cases;
  double eta_high_s = -1;         ///< negative: unknown.
  double samples_left = -1;       ///< Estimated samples to the target; negative: unknown.
  bool target_met = false;        ///< Known when the job is done.
  double target_share = 0;        ///< Of pixels that meet kRelativeError, at the last round's end.
  double submitted_unix_s = 0;
  double wall_s = 0;    ///< Since submission, until the end.
  double load_s = 0;    ///< Longest time a worker took to load the scene.
  double render_s = 0;  ///< From the start of the first unit to the last merge.
  /// Of the crop; in these no rays are traced. 0 until a worker has said so.
  int64_t background_pixels = 0;
  int workers = 0;                     ///< Workers that hold a lease of this job now.
  std::vector<TileError> worst_tiles;  ///< At most 5, worst first.
  Digest result;  ///< Over counts, means and moments of the film; valid when done.
};

struct WorkerStatus {
  std::string id, name, state;  ///< state: "idle", "busy", "draining", "lost".
  std::vector<std::string> tags;
  uint32_t threads = 0;
  int leases = 0;
  uint64_t samples = 0;  ///< Merged from this worker since it joined.
  double connected_s = 0;
  double silent_s = 0;  ///< Since the last byte heard.
  std::string build;
};

struct LogLine {
  double unix_s = 0;
  std::string level;  ///< "info", "warning", "error".
  std::string text;
};

/// The layers of a job's image as floats, row-major over the crop, pixel-interleaved in the order
/// of `channels`: R G B, plain channels, stderr.*, ci95.*, variance.*, samples.Y, flags.Y. Without
/// stderr.* and ci95.* where the sampler claims no interval.
struct ImageLayers {
  int full_width = 0, full_height = 0;
  PixelRect crop;
  std::vector<std::string> channels;
  std::vector<float> values;
  /// For the EXR's header: job spec, seed, scene digest, build, counts, result digest.
  std::vector<std::pair<std::string, std::string>> metadata;
};

/// Bits of the flags layer.
inline constexpr uint32_t kFlagSkew = 1;        ///< Too few samples for the skewness around it.
inline constexpr uint32_t kFlagNonFinite = 2;   ///< A sample was NaN or infinite: no interval.
inline constexpr uint32_t kFlagNoInterval = 4;  ///< The sampler's replicates are not independent.

}  // namespace strata
