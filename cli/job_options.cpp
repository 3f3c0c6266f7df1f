#include "cli/job_options.h"

#include <cmath>

#include "cli/exit_status.h"
#include "cli/scene_images.h"
#include "cli/scene_summary.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

/// Refuses what later versions will do, with what to do today.
absl::Status CheckNothingMissing(const JobOptions& options) {
  if (!options.integrator) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "--integrator is not there yet in this version; leave it out: jobs are path traced");
}

/// `crop` of a frame of `from` pixels as the same part of a frame of `to` pixels, each border at
/// the pixel that pbrt-v4's fractional crop windows would give.
PixelRect ScaleCrop(const PixelRect& crop, Resolution from, Resolution to) {
  const auto scale = [](int x, int from_size, int to_size) {
    return static_cast<int>((static_cast<int64_t>(x) * to_size + from_size - 1) / from_size);
  };
  return {scale(crop.x0, from.width, to.width), scale(crop.y0, from.height, to.height),
          scale(crop.x1, from.width, to.width), scale(crop.y1, from.height, to.height)};
}

absl::Status ResolveFrame(const JobOptions& options, const FrameDefaults& defaults, JobSpec* spec) {
  Resolution resolution{defaults.width, defaults.height};
  if (options.resolution) {
    STRATA_ASSIGN_OR_RETURN(resolution, ParseResolution(*options.resolution));
  }
  spec->width = resolution.width;
  spec->height = resolution.height;
  spec->crop = {0, 0, spec->width, spec->height};
  if (options.crop) {
    STRATA_ASSIGN_OR_RETURN(spec->crop, ParseCrop(*options.crop));
  } else if (defaults.crop) {
    spec->crop = ScaleCrop(*defaults.crop, {defaults.width, defaults.height}, resolution);
  }
  return absl::OkStatus();
}

/// Samples per pixel a job with a target may take where --spp does not say: a scene's own number
/// was not meant as a cap.
constexpr uint32_t kDefaultCap = 1 << 16;

absl::Status ResolveTarget(const JobOptions& options, JobSpec* spec) {
  if ((options.error ? 1 : 0) + (options.rmse ? 1 : 0) + (options.time ? 1 : 0) > 1) {
    return absl::InvalidArgumentError(
        "--error, --rmse and --time exclude each other, give one of them");
  }
  if (options.error) {
    spec->target = TargetKind::kRelativeError;
    STRATA_ASSIGN_OR_RETURN(spec->target_value, ParseRelativeError(*options.error));
  } else if (options.rmse) {
    spec->target = TargetKind::kRmse;
    STRATA_ASSIGN_OR_RETURN(spec->target_value, ParseRmse(*options.rmse));
  } else if (options.time) {
    spec->target = TargetKind::kTime;
    STRATA_ASSIGN_OR_RETURN(spec->target_value, ParseTime(*options.time));
  }
  spec->allocation =
      ClaimsInterval(spec->sampler) ? AllocationKind::kRing : AllocationKind::kUniform;
  if (!options.allocation) return absl::OkStatus();
  const absl::StatusOr<AllocationKind> kind = ParseAllocationKind(*options.allocation);
  if (!kind.ok()) return Annotate(kind.status(), "--allocation");
  spec->allocation = *kind;
  return absl::OkStatus();
}

/// Samplers that claim no interval have no error to aim at, nor to spread samples by.
absl::Status CheckInterval(const JobOptions& options, const JobSpec& spec,
                           std::vector<std::string>* notes) {
  if (ClaimsInterval(spec.sampler)) return absl::OkStatus();
  const std::string sampler = absl::StrCat("--sampler ", std::string(ToString(spec.sampler)));
  if (options.error || options.rmse) {
    return absl::InvalidArgumentError(absl::StrCat(
        options.error ? "--error: " : "--rmse: ", sampler,
        " claims no interval, since its replicates are not independent; give another sampler, or "
        "--spp alone"));
  }
  if (spec.allocation != AllocationKind::kUniform) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--allocation: ", sampler,
        " claims no interval to spread samples by; give --allocation uniform, or leave it out"));
  }
  notes->push_back(sampler + " claims no interval: its replicates are not independent");
  return absl::OkStatus();
}

/// A positive multiple of the replicates.
absl::StatusOr<uint32_t> ResolveSpp(const JobOptions& options, uint32_t default_spp,
                                    std::vector<std::string>* notes) {
  const uint64_t asked = options.spp.value_or(default_spp);
  if (asked < 1 || asked > kMaxSpp) {
    return absl::InvalidArgumentError(
        absl::StrCat("--spp: ", asked, " is out of range, give 1 to ", kMaxSpp));
  }
  const uint64_t spp = (asked + kReplicates - 1) / kReplicates * kReplicates;
  if (spp != asked) {
    notes->push_back(absl::StrCat(options.spp ? "--spp " : "the scene's ", asked,
                                  options.spp ? "" : " samples per pixel", " is rounded up to ",
                                  spp, ": eight replicates share the samples equally"));
  }
  return static_cast<uint32_t>(spp);
}

/// The file's name without its extension; its folder's where the file is just called "scene".
std::string DefaultName(const fs::path& scene) {
  const std::string stem = scene.stem().string();
  const std::string folder = scene.parent_path().filename().string();
  return stem == "scene" && !folder.empty() ? folder : stem;
}

/// Takes --camera, --light-selection and --env. An image inside the root has its place in it;
/// another one gets a place in a folder that the scene does not have.
absl::Status AddOptions(const JobOptions& options, ScenePath* path) {
  path->options.camera = options.camera.value_or("");
  if (options.light_selection) {
    const auto selection = ParseLightSelection(*options.light_selection);
    if (!selection.ok()) return Annotate(selection.status(), "--light-selection");
    path->options.light_selection = *selection;
  }
  if (!options.environment) return absl::OkStatus();
  std::error_code error;
  const fs::path image = fs::canonical(*options.environment, error);
  if (error || !fs::is_regular_file(image, error)) {
    return absl::InvalidArgumentError(
        absl::StrCat("--env: ", *options.environment, ": there is no such file, give an image"));
  }
  const fs::path relative = image.lexically_relative(path->root);
  if (!relative.empty() && *relative.begin() != "..") {
    path->options.environment = relative.generic_string();
    return absl::OkStatus();
  }
  std::string folder = "environment";
  while (fs::exists(path->root / folder, error)) folder += "-of-job";
  path->options.environment = absl::StrCat(folder, "/", image.filename().string());
  path->elsewhere[path->options.environment] = image;
  return absl::OkStatus();
}

}  // namespace

void AddSceneOptions(CLI::App* command, JobOptions& options) {
  command->add_option("SCENE", options.scene, "The scene: a pbrt-v4 file, or glTF 2.0")->required();
  command
      ->add_option("--root", options.root,
                   "Directory that contains all files of the scene (default: the scene's)")
      ->type_name("DIR");
}

void AddJobOptions(CLI::App* command, JobOptions& options) {
  AddSceneOptions(command, options);
  const std::string group = "Job options (default: what the scene file says)";
  const auto add = [&](const char* name, auto& value, const char* what, const char* type) {
    return command->add_option(name, value, what)->type_name(type)->group(group);
  };
  add("--spp", options.spp,
      "Samples per pixel on average, rounded up to a multiple of 8; with a target, the most "
      "(default "
      "65536)",
      "N")
      ->check(CLI::NonNegativeNumber);
  add("--error", options.error,
      "Target: 95 % half-width over luminance, for 99 % of pixels, such as 2%", "E");
  add("--rmse", options.rmse, "Target: root mean square of the standard errors", "E");
  add("--time", options.time, "Target: time from the first unit on, such as 90s, 15m, 2h", "T");
  add("--resolution", options.resolution, "Size of the full frame in pixels", "WxH");
  add("--crop", options.crop, "Render these pixels alone; x1 and y1 excluded", "x0,y0,x1,y1");
  add("--max-depth", options.max_depth, "Most bounces of a path", "D");
  add("--sampler", options.sampler,
      "sobol, independent, halton, stratified, latin_hypercube, poisson_disk; halton_plain and "
      "drand48 claim no interval",
      "NAME");
  add("--strategy", options.strategy,
      "How paths find light: mis (default), light, bsdf, cosine or uniform; to compare", "NAME");
  add("--mis-beta", options.mis_beta,
      "Exponent of the weights of mis: 1 is the balance heuristic, 2 the power heuristic "
      "(default); 0 to 100",
      "B");
  add("--light-selection", options.light_selection,
      "How one light of many is chosen: tree (default), intensity or uniform; to compare", "NAME");
  add("--routines", options.routines,
      "How random numbers become points of disks, triangles and hemispheres: preserving (default), "
      "plain or rejection; to compare",
      "NAME");
  add("--roulette", options.roulette,
      "What ends paths early: throughput (default), efficiency, or off", "NAME");
  add("--kernel", options.kernel, "fast (default), or reference: plain code, to compare with",
      "NAME");
  add("--env", options.environment,
      "Image that lights the scene from all around, in place of its infinite lights: square ones "
      "in "
      "pbrt-v4's layout, others latitude and longitude",
      "IMAGE");
  add("--camera", options.camera,
      "Where the camera stands, where it looks, degrees over the shorter edge (40); or name or "
      "index "
      "of a glTF camera",
      "x,y,z,x,y,z[,FOV]");
  add("--filter", options.filter, "box, triangle, gaussian or mitchell; radius in pixels",
      "NAME[:radius]");
  add("--allocation", options.allocation,
      "How samples are spread over pixels: ring (default), uniform, or greedy (biased)", "NAME");
  add("--tile", options.tile, "Edge of a tile in pixels (default 32); decides no bit", "N");
  add("--seed", options.seed,
      "Another seed is another, independent render (default 0); drand48 has 2^32 of them", "S")
      ->check(CLI::NonNegativeNumber);
  add("--frame", options.frame, "Frame number; enters the random numbers (default 0)", "F")
      ->check(CLI::NonNegativeNumber);
  add("--channels", options.channels, "Further channels: alpha,albedo,normal,depth", "LIST");
  add("--reproducible", options.reproducible,
      "Refuse workers that would give other bits (default true)", "BOOL");
  add("--name", options.name, "What the job is called", "NAME");
  add("--priority", options.priority, "-100 to 100, higher first (default 0)", "P");
  command->add_option("--integrator", options.integrator)->group("");
}

std::string ScenePath::Located(const std::string& message) const {
  const std::string file = message.substr(0, message.find(':'));
  std::error_code ignored;
  const bool names_file =
      !file.empty() && fs::path(file).is_relative() && fs::is_regular_file(root / file, ignored);
  return names_file && !typed_root.empty() ? (fs::path(typed_root) / message).string() : message;
}

std::filesystem::path ScenePath::Typed(const std::string& bundle_path) const {
  const auto found = elsewhere.find(bundle_path);
  return found == elsewhere.end() ? fs::path(typed_root) / bundle_path : found->second;
}

absl::StatusOr<ScenePath> FindScene(const JobOptions& options) {
  const fs::path typed(options.scene);
  std::error_code error;
  const fs::path scene = fs::canonical(typed, error);
  if (error || !fs::is_regular_file(scene, error)) {
    return absl::InvalidArgumentError(
        absl::StrCat(options.scene, ": there is no such file, give a pbrt-v4 or glTF scene"));
  }
  if (!options.root) {
    ScenePath path{scene.parent_path(), scene.filename().string(), typed.parent_path().string()};
    STRATA_RETURN_IF_ERROR(AddOptions(options, &path));
    return path;
  }
  const fs::path root = fs::canonical(*options.root, error);
  if (error || !fs::is_directory(root, error)) {
    return absl::InvalidArgumentError(absl::StrCat(
        "--root: ", *options.root, " is no directory, give one that contains the scene"));
  }
  const fs::path relative = scene.lexically_relative(root);
  if (relative.empty() || *relative.begin() == "..") {
    return absl::InvalidArgumentError(absl::StrCat("--root: ", *options.root, " does not contain ",
                                                   options.scene, ", give a directory that does"));
  }
  ScenePath path{root, relative.generic_string(), *options.root};
  STRATA_RETURN_IF_ERROR(AddOptions(options, &path));
  return path;
}

absl::StatusOr<LoadedScene> ReadScene(const JobOptions& options) {
  std::vector<std::string> ignored;
  STRATA_RETURN_IF_ERROR(ResolveJobSpec(options, FrameDefaults{}, &ignored).status());
  LoadedScene loaded;
  STRATA_ASSIGN_OR_RETURN(loaded.path, FindScene(options));
  absl::StatusOr<SceneFile> file =
      ReadSceneFile(loaded.path.Source(), loaded.path.scene, loaded.path.options);
  if (!file.ok()) {
    return absl::InvalidArgumentError(loaded.path.Located(std::string(file.status().message())));
  }
  loaded.file = *std::move(file);
  return loaded;
}

absl::StatusOr<JobSpec> ResolveJobSpec(const JobOptions& options, const FrameDefaults& defaults,
                                       std::vector<std::string>* notes) {
  STRATA_RETURN_IF_ERROR(CheckNothingMissing(options));
  JobSpec spec;
  STRATA_RETURN_IF_ERROR(ResolveFrame(options, defaults, &spec));
  spec.sampler = defaults.sampler;
  if (options.sampler) {
    const absl::StatusOr<SamplerKind> kind = ParseSamplerKind(*options.sampler);
    if (!kind.ok()) return Annotate(kind.status(), "--sampler");
    spec.sampler = *kind;
  }
  STRATA_RETURN_IF_ERROR(ResolveTarget(options, &spec));
  STRATA_RETURN_IF_ERROR(CheckInterval(options, spec, notes));
  if (spec.allocation == AllocationKind::kGreedy) {
    notes->push_back("--allocation greedy makes a biased image, for comparison only");
  }
  const bool capped = spec.target != TargetKind::kSamples;
  STRATA_ASSIGN_OR_RETURN(spec.spp,
                          ResolveSpp(options, capped ? kDefaultCap : defaults.spp, notes));
  spec.name = options.name.value_or(DefaultName(fs::absolute(options.scene)));
  spec.priority = options.priority.value_or(spec.priority);
  spec.max_depth = options.max_depth.value_or(defaults.max_depth);
  if (options.strategy) {
    const absl::StatusOr<DirectStrategy> strategy = ParseDirectStrategy(*options.strategy);
    if (!strategy.ok()) return Annotate(strategy.status(), "--strategy");
    spec.strategy = *strategy;
  }
  if (options.routines) {
    const absl::StatusOr<SamplingRoutines> routines = ParseSamplingRoutines(*options.routines);
    if (!routines.ok()) return Annotate(routines.status(), "--routines");
    spec.routines = *routines;
  }
  spec.mis_beta = options.mis_beta.value_or(spec.mis_beta);
  if (!(spec.mis_beta >= 0 && spec.mis_beta <= kMaxMisBeta))
    return absl::InvalidArgumentError(absl::StrCat("--mis-beta must be 0 to ", kMaxMisBeta));
  if (options.roulette) {
    const absl::StatusOr<RouletteKind> kind = ParseRouletteKind(*options.roulette);
    if (!kind.ok()) return Annotate(kind.status(), "--roulette");
    spec.roulette = *kind;
  }
  if (options.kernel) {
    const absl::StatusOr<KernelKind> kind = ParseKernelKind(*options.kernel);
    if (!kind.ok()) return Annotate(kind.status(), "--kernel");
    spec.kernel = *kind;
  }
  spec.filter = defaults.filter;
  if (options.filter) {
    STRATA_ASSIGN_OR_RETURN(spec.filter, ParseFilter(*options.filter));
  }
  if (options.channels) {
    STRATA_ASSIGN_OR_RETURN(spec.channels, ParseChannels(*options.channels));
  }
  spec.tile = options.tile.value_or(spec.tile);
  spec.seed = options.seed.value_or(spec.seed);
  spec.frame = options.frame.value_or(spec.frame);
  spec.reproducible = options.reproducible.value_or(spec.reproducible);
  return spec;
}

absl::StatusOr<ResolvedJob> ResolveJob(const JobOptions& options, const LoadedScene& loaded) {
  ResolvedJob job;
  job.root = loaded.path.root;
  job.elsewhere = loaded.path.elsewhere;
  STRATA_ASSIGN_OR_RETURN(job.spec,
                          ResolveJobSpec(options, loaded.file.scene.defaults, &job.notes));
  if (loaded.file.unused.Any()) {
    job.notes.push_back(
        absl::StrCat("not used, so neither sent nor built: ", UnusedLine(loaded.file.unused)));
  }
  for (const SceneWarning& warning : loaded.file.warnings) {
    job.warnings.push_back(WarningLine(loaded.path, warning));
  }
  STRATA_RETURN_IF_ERROR(CheckImages(loaded));
  absl::StatusOr<Bundle> bundle =
      MakeBundle(loaded.path.Source(), loaded.path.scene, loaded.file.files, loaded.path.options);
  if (!bundle.ok()) return AsBadInput(bundle.status());
  job.spec.bundle = *std::move(bundle);
  STRATA_RETURN_IF_ERROR(ValidateJobSpec(job.spec));
  return job;
}

absl::StatusOr<ResolvedJob> ResolveJob(const JobOptions& options) {
  STRATA_ASSIGN_OR_RETURN(const LoadedScene loaded, ReadScene(options));
  return ResolveJob(options, loaded);
}

std::string WarningLine(const ScenePath& path, const SceneWarning& warning) {
  return path.Located(absl::StrCat(warning.where.ToString(), ": warning: ", warning.text));
}

}  // namespace strata
