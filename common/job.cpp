#include "common/job.h"

#include <absl/strings/ascii.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace strata {
namespace {

constexpr int kMaxFrameEdge = 65536;
constexpr size_t kMaxNameBytes = 256;
constexpr double kMaxFilterRadius = 64;

constexpr std::array<std::pair<SamplerKind, std::string_view>, 8> kSamplerNames = {{
    {SamplerKind::kSobol, "sobol"},
    {SamplerKind::kIndependent, "independent"},
    {SamplerKind::kHalton, "halton"},
    {SamplerKind::kHaltonPlain, "halton_plain"},
    {SamplerKind::kStratified, "stratified"},
    {SamplerKind::kLatinHypercube, "latin_hypercube"},
    {SamplerKind::kPoissonDisk, "poisson_disk"},
    {SamplerKind::kDrand48, "drand48"},
}};
constexpr std::array<std::pair<DirectStrategy, std::string_view>, 5> kStrategyNames = {{
    {DirectStrategy::kMis, "mis"},
    {DirectStrategy::kLightOnly, "light"},
    {DirectStrategy::kBsdfOnly, "bsdf"},
    {DirectStrategy::kCosine, "cosine"},
    {DirectStrategy::kUniform, "uniform"},
}};
constexpr std::array<std::pair<SamplingRoutines, std::string_view>, 3> kRoutinesNames = {{
    {SamplingRoutines::kPreserving, "preserving"},
    {SamplingRoutines::kPlain, "plain"},
    {SamplingRoutines::kRejection, "rejection"},
}};
constexpr std::array<std::pair<LightSelection, std::string_view>, 3> kLightSelectionNames = {{
    {LightSelection::kTree, "tree"},
    {LightSelection::kIntensity, "intensity"},
    {LightSelection::kUniform, "uniform"},
}};
constexpr std::array<std::pair<RouletteKind, std::string_view>, 3> kRouletteNames = {{
    {RouletteKind::kThroughput, "throughput"},
    {RouletteKind::kOff, "off"},
    {RouletteKind::kEfficiency, "efficiency"},
}};
constexpr std::array<std::pair<KernelKind, std::string_view>, 2> kKernelNames = {{
    {KernelKind::kFast, "fast"},
    {KernelKind::kReference, "reference"},
}};
constexpr std::array<std::pair<AllocationKind, std::string_view>, 3> kAllocationNames = {{
    {AllocationKind::kUniform, "uniform"},
    {AllocationKind::kRing, "ring"},
    {AllocationKind::kGreedy, "greedy"},
}};
constexpr std::array<std::pair<TargetKind, std::string_view>, 4> kTargetNames = {{
    {TargetKind::kSamples, "samples"},
    {TargetKind::kRelativeError, "error"},
    {TargetKind::kRmse, "rmse"},
    {TargetKind::kTime, "time"},
}};
constexpr std::array<std::pair<FilterKind, std::string_view>, 4> kFilterNames = {{
    {FilterKind::kBox, "box"},
    {FilterKind::kTriangle, "triangle"},
    {FilterKind::kGaussian, "gaussian"},
    {FilterKind::kMitchell, "mitchell"},
}};

template <typename Table, typename Kind>
std::string_view NameOf(const Table& table, Kind kind) {
  for (const auto& [value, name] : table) {
    if (value == kind) return name;
  }
  return "unknown";
}

template <typename Table>
auto ParseName(const Table& table, std::string_view what, std::string_view name)
    -> absl::StatusOr<decltype(table[0].first)> {
  std::string known;
  for (const auto& [value, known_name] : table) {
    if (known_name == name) return value;
    known.append(known.empty() ? "" : ", ").append(known_name);
  }
  return absl::InvalidArgumentError(
      fmt::format("{} \"{}\" is not known; choose one of {}", what, name, known));
}

absl::Status Bad(std::string_view field, std::string_view reason) {
  return absl::InvalidArgumentError(fmt::format("{}: {}", field, reason));
}

absl::Status CheckRange(std::string_view field, int64_t value, int64_t low, int64_t high) {
  if (value >= low && value <= high) return absl::OkStatus();
  return Bad(field, fmt::format("{} is not in {} to {}", value, low, high));
}

absl::Status CheckPositive(std::string_view field, double value, double high) {
  if (value > 0 && value <= high) return absl::OkStatus();  // False for NaN too.
  return Bad(field, fmt::format("{} is not above 0 and at most {}", value, high));
}

absl::Status ValidateFilter(const FilterSpec& filter) {
  if (NameOf(kFilterNames, filter.kind) == "unknown") return Bad("filter.kind", "is not known");
  STRATA_RETURN_IF_ERROR(CheckPositive("filter.radius_x", filter.radius_x, kMaxFilterRadius));
  STRATA_RETURN_IF_ERROR(CheckPositive("filter.radius_y", filter.radius_y, kMaxFilterRadius));
  STRATA_RETURN_IF_ERROR(CheckPositive("filter.sigma", filter.sigma, kMaxFilterRadius));
  if (!(std::abs(filter.b) <= 10)) return Bad("filter.b", "is not a number in -10 to 10");
  if (!(std::abs(filter.c) <= 10)) return Bad("filter.c", "is not a number in -10 to 10");
  return absl::OkStatus();
}

absl::Status ValidateCrop(const JobSpec& spec) {
  const PixelRect& crop = spec.crop;
  if (crop.x0 >= crop.x1 || crop.y0 >= crop.y1) return Bad("crop", "holds no pixel");
  if (crop.x0 < 0 || crop.y0 < 0 || crop.x1 > spec.width || crop.y1 > spec.height) {
    return Bad("crop", fmt::format("{},{},{},{} reaches outside the frame of {}x{}", crop.x0,
                                   crop.y0, crop.x1, crop.y1, spec.width, spec.height));
  }
  return absl::OkStatus();
}

/// For samplers whose samples do not tell their error.
absl::Status CheckNeedsNoError(const JobSpec& spec) {
  const std::string why =
      fmt::format("{} claims no interval, since its replicates are not independent; ",
                  NameOf(kSamplerNames, spec.sampler));
  if (spec.target == TargetKind::kRelativeError || spec.target == TargetKind::kRmse) {
    return Bad("sampler", why + "an error target needs another sampler, such as sobol");
  }
  if (spec.allocation != AllocationKind::kUniform) {
    return Bad("sampler", why + "choose allocation uniform, or another sampler");
  }
  return absl::OkStatus();
}

absl::Status ValidateTarget(const JobSpec& spec) {
  if (NameOf(kAllocationNames, spec.allocation) == "unknown") {
    return Bad("allocation", "is not known");
  }
  if (NameOf(kTargetNames, spec.target) == "unknown") return Bad("target", "is not known");
  if (!ClaimsInterval(spec.sampler)) STRATA_RETURN_IF_ERROR(CheckNeedsNoError(spec));
  if (spec.target == TargetKind::kSamples) return absl::OkStatus();
  if (spec.allocation == AllocationKind::kGreedy) {
    return Bad("allocation", "greedy is biased and has no target; choose ring or uniform");
  }
  constexpr int kLeastEdge = 8;  // What is around a pixel decides, so there must be something.
  if (spec.target != TargetKind::kTime &&
      (spec.crop.Width() < kLeastEdge || spec.crop.Height() < kLeastEdge)) {
    return Bad("crop", fmt::format("an error target needs at least {0}x{0} pixels", kLeastEdge));
  }
  constexpr double kLargestTarget = 1e30;
  return CheckPositive("target_value", spec.target_value, kLargestTarget);
}

}  // namespace

absl::Status ValidateJobSpec(const JobSpec& spec) {
  if (spec.name.size() > kMaxNameBytes) {
    return Bad("name", fmt::format("is longer than {} bytes", kMaxNameBytes));
  }
  if (std::any_of(spec.name.begin(), spec.name.end(), absl::ascii_iscntrl)) {
    return Bad("name", "holds a control character");
  }
  STRATA_RETURN_IF_ERROR(CheckRange("priority", spec.priority, -100, 100));
  STRATA_RETURN_IF_ERROR(Annotate(ValidateBundle(spec.bundle), "bundle"));
  STRATA_RETURN_IF_ERROR(CheckRange("width", spec.width, 1, kMaxFrameEdge));
  STRATA_RETURN_IF_ERROR(CheckRange("height", spec.height, 1, kMaxFrameEdge));
  STRATA_RETURN_IF_ERROR(ValidateCrop(spec));
  STRATA_RETURN_IF_ERROR(CheckRange("max_depth", spec.max_depth, 0, 100000));
  if (NameOf(kSamplerNames, spec.sampler) == "unknown") return Bad("sampler", "is not known");
  if (NameOf(kStrategyNames, spec.strategy) == "unknown") return Bad("strategy", "is not known");
  if (!(spec.mis_beta >= 0 && spec.mis_beta <= kMaxMisBeta))
    return Bad("mis_beta", fmt::format("{} is not in 0..{}", spec.mis_beta, kMaxMisBeta));
  if (NameOf(kRoutinesNames, spec.routines) == "unknown") return Bad("routines", "are not known");
  if (NameOf(kLightSelectionNames, spec.bundle.options.light_selection) == "unknown")
    return Bad("bundle.light_selection", "is not known");
  if (NameOf(kRouletteNames, spec.roulette) == "unknown") return Bad("roulette", "is not known");
  if (NameOf(kKernelNames, spec.kernel) == "unknown") return Bad("kernel", "is not known");
  STRATA_RETURN_IF_ERROR(ValidateFilter(spec.filter));
  if (spec.spp == 0 || spec.spp % kReplicates != 0) {
    return Bad("spp", fmt::format("{} is not a positive multiple of {}", spec.spp, kReplicates));
  }
  STRATA_RETURN_IF_ERROR(CheckRange("spp", spec.spp, 1, kMaxSpp));
  STRATA_RETURN_IF_ERROR(ValidateTarget(spec));
  return CheckRange("tile", spec.tile, 8, 1024);
}

bool ClaimsInterval(SamplerKind kind) {
  return kind != SamplerKind::kHaltonPlain && kind != SamplerKind::kDrand48;
}

PixelLayout LayoutOf(const JobSpec& spec) {
  PixelLayout layout;
  layout.plain = static_cast<int>(PlainChannelNames(spec.channels).size());
  return layout;
}

std::vector<std::string> PlainChannelNames(const ExtraChannels& channels) {
  std::vector<std::string> names;
  if (channels.alpha) names.push_back("A");
  if (channels.albedo) names.insert(names.end(), {"albedo.R", "albedo.G", "albedo.B"});
  if (channels.normal) names.insert(names.end(), {"normal.X", "normal.Y", "normal.Z"});
  if (channels.depth) names.push_back("depth.Z");
  return names;
}

std::string_view ToString(SamplerKind kind) { return NameOf(kSamplerNames, kind); }
std::string_view ToString(DirectStrategy strategy) { return NameOf(kStrategyNames, strategy); }
std::string_view ToString(SamplingRoutines routines) { return NameOf(kRoutinesNames, routines); }
std::string_view ToString(LightSelection selection) {
  return NameOf(kLightSelectionNames, selection);
}
std::string_view ToString(RouletteKind kind) { return NameOf(kRouletteNames, kind); }
std::string_view ToString(KernelKind kind) { return NameOf(kKernelNames, kind); }
std::string_view ToString(AllocationKind kind) { return NameOf(kAllocationNames, kind); }
std::string_view ToString(TargetKind kind) { return NameOf(kTargetNames, kind); }
std::string_view ToString(FilterKind kind) { return NameOf(kFilterNames, kind); }

absl::StatusOr<SamplerKind> ParseSamplerKind(std::string_view name) {
  return ParseName(kSamplerNames, "sampler", name);
}
absl::StatusOr<DirectStrategy> ParseDirectStrategy(std::string_view name) {
  return ParseName(kStrategyNames, "strategy", name);
}
absl::StatusOr<SamplingRoutines> ParseSamplingRoutines(std::string_view name) {
  return ParseName(kRoutinesNames, "routines", name);
}
absl::StatusOr<LightSelection> ParseLightSelection(std::string_view name) {
  return ParseName(kLightSelectionNames, "light selection", name);
}
absl::StatusOr<RouletteKind> ParseRouletteKind(std::string_view name) {
  return ParseName(kRouletteNames, "roulette", name);
}
absl::StatusOr<KernelKind> ParseKernelKind(std::string_view name) {
  return ParseName(kKernelNames, "kernel", name);
}
absl::StatusOr<AllocationKind> ParseAllocationKind(std::string_view name) {
  return ParseName(kAllocationNames, "allocation", name);
}
absl::StatusOr<FilterKind> ParseFilterKind(std::string_view name) {
  return ParseName(kFilterNames, "filter", name);
}

FilterSpec DefaultFilter(FilterKind kind) {
  FilterSpec filter;
  filter.kind = kind;
  switch (kind) {
    case FilterKind::kBox:
      filter.radius_x = filter.radius_y = 0.5;
      break;
    case FilterKind::kGaussian:
      filter.radius_x = filter.radius_y = 1.5;
      break;
    case FilterKind::kTriangle:
    case FilterKind::kMitchell:
      filter.radius_x = filter.radius_y = 2;
      break;
  }
  return filter;
}

}  // namespace strata
