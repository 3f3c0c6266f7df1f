#include "common/wire/job.h"

#include "common/wire/field.h"

namespace strata::wire {
namespace {

constexpr std::pair<SamplerKind, v1::SamplerKind> kSamplers[] = {
    {SamplerKind::kSobol, v1::SAMPLER_KIND_SOBOL},
    {SamplerKind::kIndependent, v1::SAMPLER_KIND_INDEPENDENT},
    {SamplerKind::kHalton, v1::SAMPLER_KIND_HALTON},
    {SamplerKind::kHaltonPlain, v1::SAMPLER_KIND_HALTON_PLAIN},
    {SamplerKind::kStratified, v1::SAMPLER_KIND_STRATIFIED},
    {SamplerKind::kLatinHypercube, v1::SAMPLER_KIND_LATIN_HYPERCUBE},
    {SamplerKind::kPoissonDisk, v1::SAMPLER_KIND_POISSON_DISK},
    {SamplerKind::kDrand48, v1::SAMPLER_KIND_DRAND48},
};
// Where there is no such choice in a client's version, it sends the last value.
constexpr std::pair<DirectStrategy, v1::DirectStrategy> kStrategies[] = {
    {DirectStrategy::kMis, v1::DIRECT_STRATEGY_MIS},
    {DirectStrategy::kLightOnly, v1::DIRECT_STRATEGY_LIGHT},
    {DirectStrategy::kBsdfOnly, v1::DIRECT_STRATEGY_BSDF},
    {DirectStrategy::kCosine, v1::DIRECT_STRATEGY_COSINE},
    {DirectStrategy::kUniform, v1::DIRECT_STRATEGY_UNIFORM},
    {DirectStrategy::kMis, v1::DIRECT_STRATEGY_UNSPECIFIED},
};
constexpr std::pair<SamplingRoutines, v1::SamplingRoutines> kRoutines[] = {
    {SamplingRoutines::kPreserving, v1::SAMPLING_ROUTINES_PRESERVING},
    {SamplingRoutines::kPlain, v1::SAMPLING_ROUTINES_PLAIN},
    {SamplingRoutines::kRejection, v1::SAMPLING_ROUTINES_REJECTION},
    {SamplingRoutines::kPreserving, v1::SAMPLING_ROUTINES_UNSPECIFIED},
};
constexpr std::pair<LightSelection, v1::LightSelection> kLightSelections[] = {
    {LightSelection::kTree, v1::LIGHT_SELECTION_TREE},
    {LightSelection::kIntensity, v1::LIGHT_SELECTION_INTENSITY},
    {LightSelection::kUniform, v1::LIGHT_SELECTION_UNIFORM},
    {LightSelection::kTree, v1::LIGHT_SELECTION_UNSPECIFIED},
};
constexpr std::pair<RouletteKind, v1::RouletteKind> kRoulettes[] = {
    {RouletteKind::kThroughput, v1::ROULETTE_KIND_THROUGHPUT},
    {RouletteKind::kOff, v1::ROULETTE_KIND_OFF},
    {RouletteKind::kEfficiency, v1::ROULETTE_KIND_EFFICIENCY},
    {RouletteKind::kThroughput, v1::ROULETTE_KIND_UNSPECIFIED},
};
constexpr std::pair<KernelKind, v1::KernelKind> kKernels[] = {
    {KernelKind::kFast, v1::KERNEL_KIND_FAST},
    {KernelKind::kReference, v1::KERNEL_KIND_REFERENCE},
};
constexpr std::pair<AllocationKind, v1::AllocationKind> kAllocations[] = {
    {AllocationKind::kUniform, v1::ALLOCATION_KIND_UNIFORM},
    {AllocationKind::kRing, v1::ALLOCATION_KIND_RING},
    {AllocationKind::kGreedy, v1::ALLOCATION_KIND_GREEDY},
};
constexpr std::pair<TargetKind, v1::TargetKind> kTargets[] = {
    {TargetKind::kSamples, v1::TARGET_KIND_SAMPLES},
    {TargetKind::kRelativeError, v1::TARGET_KIND_RELATIVE_ERROR},
    {TargetKind::kRmse, v1::TARGET_KIND_RMSE},
    {TargetKind::kTime, v1::TARGET_KIND_TIME},
};
constexpr std::pair<FilterKind, v1::FilterKind> kFilters[] = {
    {FilterKind::kBox, v1::FILTER_KIND_BOX},
    {FilterKind::kTriangle, v1::FILTER_KIND_TRIANGLE},
    {FilterKind::kGaussian, v1::FILTER_KIND_GAUSSIAN},
    {FilterKind::kMitchell, v1::FILTER_KIND_MITCHELL},
};

/// The first value, which stands for none, where the table does not have it.
template <class Plain, class Wire, size_t kSize>
Wire EnumToWire(const std::pair<Plain, Wire> (&table)[kSize], Plain value) {
  for (const auto& [plain, message] : table) {
    if (plain == value) return message;
  }
  return Wire{};
}

template <class Table, class Wire, class Plain>
absl::Status EnumFromWire(const Table& table, Wire value, std::string_view field, Plain* result) {
  for (const auto& [plain, message] : table) {
    if (message == value) {
      *result = plain;
      return absl::OkStatus();
    }
  }
  return FieldError(field, absl::StrCat("unknown value ", static_cast<int>(value)));
}

absl::StatusOr<Bundle> BundleFromWire(const v1::Bundle& message) {
  Bundle bundle;
  bundle.scene = message.scene();
  bundle.files.reserve(static_cast<size_t>(message.files_size()));
  for (int i = 0; i < message.files_size(); ++i) {
    const v1::BundleFile& file = message.files(i);
    STRATA_ASSIGN_OR_RETURN(
        const Digest digest,
        ReadDigest(file.digest(), absl::StrCat("spec.bundle.files[", i, "].digest")));
    bundle.files.push_back({file.path(), digest, file.bytes()});
  }
  bundle.options = {message.environment(), message.camera()};
  STRATA_RETURN_IF_ERROR(EnumFromWire(kLightSelections, message.light_selection(),
                                      "spec.bundle.light_selection",
                                      &bundle.options.light_selection));
  return bundle;
}

}  // namespace

void ToWire(const PixelRect& rect, v1::PixelRect* message) {
  message->set_x0(rect.x0);
  message->set_y0(rect.y0);
  message->set_x1(rect.x1);
  message->set_y1(rect.y1);
}

PixelRect FromWire(const v1::PixelRect& message) {
  return {message.x0(), message.y0(), message.x1(), message.y1()};
}

void ToWire(const JobSpec& spec, v1::JobSpec* message, bool with_files) {
  message->set_name(spec.name);
  message->set_priority(spec.priority);
  message->mutable_bundle()->set_scene(spec.bundle.scene);
  message->mutable_bundle()->set_environment(spec.bundle.options.environment);
  message->mutable_bundle()->set_camera(spec.bundle.options.camera);
  message->mutable_bundle()->set_light_selection(
      EnumToWire(kLightSelections, spec.bundle.options.light_selection));
  if (with_files) {
    for (const BundleFile& file : spec.bundle.files) {
      v1::BundleFile* out = message->mutable_bundle()->add_files();
      out->set_path(file.path);
      out->set_digest(DigestBytes(file.digest));
      out->set_bytes(file.bytes);
    }
  }
  message->set_width(spec.width);
  message->set_height(spec.height);
  ToWire(spec.crop, message->mutable_crop());
  message->set_max_depth(spec.max_depth);
  message->set_sampler(EnumToWire(kSamplers, spec.sampler));
  message->set_kernel(EnumToWire(kKernels, spec.kernel));
  message->set_strategy(EnumToWire(kStrategies, spec.strategy));
  message->set_mis_beta(spec.mis_beta);
  message->set_routines(EnumToWire(kRoutines, spec.routines));
  message->set_roulette(EnumToWire(kRoulettes, spec.roulette));
  v1::FilterSpec* filter = message->mutable_filter();
  filter->set_kind(EnumToWire(kFilters, spec.filter.kind));
  filter->set_radius_x(spec.filter.radius_x);
  filter->set_radius_y(spec.filter.radius_y);
  filter->set_sigma(spec.filter.sigma);
  filter->set_b(spec.filter.b);
  filter->set_c(spec.filter.c);
  message->set_spp(spec.spp);
  message->set_allocation(EnumToWire(kAllocations, spec.allocation));
  message->set_target(EnumToWire(kTargets, spec.target));
  message->set_target_value(spec.target_value);
  message->set_tile(spec.tile);
  message->set_seed(spec.seed);
  message->set_frame(spec.frame);
  v1::ExtraChannels* channels = message->mutable_channels();
  channels->set_alpha(spec.channels.alpha);
  channels->set_albedo(spec.channels.albedo);
  channels->set_normal(spec.channels.normal);
  channels->set_depth(spec.channels.depth);
  message->set_reproducible(spec.reproducible);
}

absl::StatusOr<JobSpec> FromWire(const v1::JobSpec& message) {
  JobSpec spec;
  STRATA_RETURN_IF_ERROR(CheckText(message.name(), 1024, false, "spec.name"));
  spec.name = message.name();
  spec.priority = message.priority();
  STRATA_ASSIGN_OR_RETURN(spec.bundle, BundleFromWire(message.bundle()));
  spec.width = message.width();
  spec.height = message.height();
  spec.crop = FromWire(message.crop());
  spec.max_depth = message.max_depth();
  STRATA_RETURN_IF_ERROR(EnumFromWire(kSamplers, message.sampler(), "spec.sampler", &spec.sampler));
  STRATA_RETURN_IF_ERROR(EnumFromWire(kKernels, message.kernel(), "spec.kernel", &spec.kernel));
  STRATA_RETURN_IF_ERROR(
      EnumFromWire(kStrategies, message.strategy(), "spec.strategy", &spec.strategy));
  STRATA_RETURN_IF_ERROR(
      EnumFromWire(kRoutines, message.routines(), "spec.routines", &spec.routines));
  if (message.has_mis_beta()) spec.mis_beta = message.mis_beta();
  STRATA_RETURN_IF_ERROR(
      EnumFromWire(kRoulettes, message.roulette(), "spec.roulette", &spec.roulette));
  const v1::FilterSpec& filter = message.filter();
  STRATA_RETURN_IF_ERROR(
      EnumFromWire(kFilters, filter.kind(), "spec.filter.kind", &spec.filter.kind));
  spec.filter.radius_x = filter.radius_x();
  spec.filter.radius_y = filter.radius_y();
  spec.filter.sigma = filter.sigma();
  spec.filter.b = filter.b();
  spec.filter.c = filter.c();
  spec.spp = message.spp();
  STRATA_RETURN_IF_ERROR(
      EnumFromWire(kAllocations, message.allocation(), "spec.allocation", &spec.allocation));
  STRATA_RETURN_IF_ERROR(EnumFromWire(kTargets, message.target(), "spec.target", &spec.target));
  spec.target_value = message.target_value();
  spec.tile = message.tile();
  spec.seed = message.seed();
  spec.frame = message.frame();
  const v1::ExtraChannels& channels = message.channels();
  spec.channels = {channels.alpha(), channels.albedo(), channels.normal(), channels.depth()};
  spec.reproducible = message.reproducible();
  return spec;
}

}  // namespace strata::wire
