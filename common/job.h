#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "common/bundle.h"
#include "common/pixel_layout.h"
#include "common/status.h"

namespace strata {

/// Names a job on its coordinator: short, printable, never reused ("j-1", "j-2", ...).
using JobId = std::string;

/// A half-open rectangle of pixels: x0 <= x < x1, y0 <= y < y1; y grows downwards.
struct PixelRect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  int Width() const { return x1 - x0; }
  int Height() const { return y1 - y0; }
  int64_t Pixels() const { return static_cast<int64_t>(Width()) * Height(); }
  bool operator==(const PixelRect&) const = default;
};

/// The most samples per pixel. Adaptive counts reach eight times as much and still fit 32 bits in
/// each replicate.
inline constexpr uint32_t kMaxSpp = 1 << 30;

/// How the numbers of a pixel's samples are drawn; worker/sampling/ says how.
enum class SamplerKind {
  kSobol,           ///< Padded Owen-scrambled Sobol' points.
  kIndependent,     ///< Independent numbers.
  kHalton,          ///< Owen-scrambled Halton points.
  kHaltonPlain,     ///< The bare Halton sequence, the same in each pixel.
  kStratified,      ///< Jittered 4x4 grids: blocks of 16 samples, as are the next two.
  kLatinHypercube,  ///< One sample in each row and column.
  kPoissonDisk,     ///< No two samples near each other.
  kDrand48,         ///< The C library's generator, one sequence for all.
};
/// Whether replicates are independent: no error can be told, or aimed at, where they are not.
bool ClaimsInterval(SamplerKind kind);

/// How paths find light. All have the same expectation; the single ones show what each costs.
/// Lights that no direction meets (point, distant, ...) are sampled, and delta reflections
/// followed, by all.
enum class DirectStrategy {
  kMis,        ///< Light and BSDF sampling, weighted (PBRT 13.4).
  kLightOnly,  ///< Light sampling wherever it can find a light.
  kBsdfOnly,   ///< Directions drawn from the BSDF.
  kCosine,     ///< Directions drawn by their cosine.
  kUniform,    ///< Directions drawn from the hemisphere, or the sphere where light passes through.
};
/// How random numbers become points of disks, triangles and hemispheres: all are uniform, and lie
/// more or less evenly where the numbers do. worker/sampling/routines.h says where it matters.
enum class SamplingRoutines {
  kPreserving,  ///< Concentric disks, triangles of low distortion: neighbours stay together.
  kPlain,       ///< Disks in polar coordinates, triangles by the square root.
  kRejection,   ///< Rejection from squares and cubes, by independent numbers.
};
/// What ends a path before its last bounce (PBRT 2.2.4).
enum class RouletteKind {
  kThroughput,  ///< Survival in proportion to the path's throughput.
  kOff,         ///< Nothing does.
  kEfficiency,  ///< The same, by what a pilot shows to be best around the pixel.
};

/// Which code follows the paths: the same estimator from the same random numbers, rounded
/// otherwise.
enum class KernelKind {
  kFast,       ///< Eight paths side by side.
  kReference,  ///< One by one, in the plainest form.
};
/// How samples are spread over pixels (design, section 5).
enum class AllocationKind {
  kUniform,
  kRing,    ///< Where the error is, as a uniform pilot shows it around each pixel. Unbiased.
  kGreedy,  ///< As each pixel's own pilot shows it: biased, for comparison only.
};
/// What ends a job. The samples per pixel end it in any case.
enum class TargetKind {
  kSamples,        ///< Nothing else does.
  kRelativeError,  ///< 95 % half-width over max(luminance, 5 % of the mean), for 99 % of pixels.
  kRmse,           ///< Root mean square of the standard errors, in units of the picture.
  kTime,           ///< Seconds since the first unit was leased.
};

enum class FilterKind { kBox, kTriangle, kGaussian, kMitchell };

/// A reconstruction filter with pbrt-v4's parameters; radii in pixels.
struct FilterSpec {
  FilterKind kind = FilterKind::kBox;
  double radius_x = 0.5, radius_y = 0.5;
  double sigma = 0.5;               ///< Gaussian: standard deviation in pixels.
  double b = 1.0 / 3, c = 1.0 / 3;  ///< Mitchell.
  bool operator==(const FilterSpec&) const = default;
};

/// Channels beside R, G, B; each is a plain mean without an error.
struct ExtraChannels {
  bool alpha = false;   ///< "A": 1 where the camera path hits a surface.
  bool albedo = false;  ///< "albedo.R/G/B": hemispherical reflectance at the first hit.
  bool normal = false;  ///< "normal.X/Y/Z": world-space shading normal at the first hit.
  bool depth = false;   ///< "depth.Z": distance along the camera's axis to the first hit.
  bool operator==(const ExtraChannels&) const = default;
};

/// An infinite exponent would give a sample whose densities are equal but for roundings to both
/// techniques or to none.
inline constexpr double kMaxMisBeta = 100;

/// All that decides the bits of a frame, but for the scene's files, which `bundle` names, and how
/// the farm treats the job (name, priority). Built by the client with every default resolved.
struct JobSpec {
  std::string name;
  int priority = 0;  ///< Higher first; -100 to 100.
  Bundle bundle;
  int width = 0, height = 0;  ///< Full frame in pixels, 1 to 65536 each.
  PixelRect crop;             ///< The pixels rendered, inside the frame, not empty.
  int max_depth = 5;          ///< Bounces, as pbrt-v4's maxdepth; 0 to 100000.
  SamplerKind sampler = SamplerKind::kSobol;
  DirectStrategy strategy = DirectStrategy::kMis;
  /// Exponent of the weights of `kMis`, 0 to kMaxMisBeta: 1 is the balance heuristic, 2 the power
  /// heuristic; large ones come near the maximum heuristic (Veach 1997, 9.2).
  double mis_beta = 2;
  SamplingRoutines routines = SamplingRoutines::kPreserving;
  RouletteKind roulette = RouletteKind::kThroughput;
  KernelKind kernel = KernelKind::kFast;
  FilterSpec filter;
  /// Samples per pixel over all replicates, on average: a multiple of 8 up to kMaxSpp. With a
  /// target, the most that are taken.
  uint32_t spp = 64;
  AllocationKind allocation = AllocationKind::kUniform;
  TargetKind target = TargetKind::kSamples;
  double target_value = 0;  ///< Above 0, but for kSamples.
  int tile = 32;            ///< Edge of a tile in pixels, 8 to 1024.
  uint64_t seed = 0;
  uint32_t frame = 0;
  ExtraChannels channels;
  bool reproducible = true;  ///< Refuse workers whose build or traced digest differs.
  bool operator==(const JobSpec&) const = default;
};

/// INVALID_ARGUMENT naming the field and the reason when a value is out of its range.
absl::Status ValidateJobSpec(const JobSpec& spec);

/// The layout of this job's pixels.
PixelLayout LayoutOf(const JobSpec& spec);

/// The names of all plain channels in layout order, as they appear in the EXR.
std::vector<std::string> PlainChannelNames(const ExtraChannels& channels);

/// "sobol", "independent", "halton", "halton_plain", "stratified", "latin_hypercube",
/// "poisson_disk", "drand48"; "mis", "light", "bsdf", "cosine", "uniform"; "preserving", "plain",
/// "rejection"; "tree", "intensity", "uniform"; "throughput", "off", "efficiency"; "fast",
/// "reference"; "uniform", "ring", "greedy"; "samples", "error", "rmse", "time"; "box", "triangle",
/// "gaussian", "mitchell".
std::string_view ToString(SamplerKind kind);
std::string_view ToString(DirectStrategy strategy);
std::string_view ToString(SamplingRoutines routines);
std::string_view ToString(LightSelection selection);
std::string_view ToString(RouletteKind kind);
std::string_view ToString(KernelKind kind);
std::string_view ToString(AllocationKind kind);
std::string_view ToString(TargetKind kind);
std::string_view ToString(FilterKind kind);
absl::StatusOr<SamplerKind> ParseSamplerKind(std::string_view name);
absl::StatusOr<DirectStrategy> ParseDirectStrategy(std::string_view name);
absl::StatusOr<SamplingRoutines> ParseSamplingRoutines(std::string_view name);
absl::StatusOr<LightSelection> ParseLightSelection(std::string_view name);
absl::StatusOr<RouletteKind> ParseRouletteKind(std::string_view name);
absl::StatusOr<KernelKind> ParseKernelKind(std::string_view name);
absl::StatusOr<AllocationKind> ParseAllocationKind(std::string_view name);
absl::StatusOr<FilterKind> ParseFilterKind(std::string_view name);
/// pbrt-v4's default radius and parameters of each filter.
FilterSpec DefaultFilter(FilterKind kind);

}  // namespace strata
