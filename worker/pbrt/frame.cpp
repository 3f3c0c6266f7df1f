#include <algorithm>
#include <cmath>

#include "worker/pbrt/entities.h"

// Film, filter, sampler and integrator.

namespace strata {
namespace {

constexpr int kMaxResolution = 65536;

bool IsOneOf(std::string_view name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// The crop of the film in pixels; x0, x1, y0, y1 as pbrt orders them.
void ReadCrop(ParameterReader& parameters, FrameDefaults& frame) {
  const std::vector<double> window = parameters.Floats("cropwindow");
  const std::vector<int> bounds = parameters.Integers("pixelbounds");
  PixelRect crop{0, 0, frame.width, frame.height};
  if (!bounds.empty()) {
    if (bounds.size() != 4) {
      parameters.Fail(parameters.where(), "\"integer pixelbounds\" wants x0 x1 y0 y1");
      return;
    }
    crop = {std::max(bounds[0], 0), std::max(bounds[2], 0), std::min(bounds[1], frame.width),
            std::min(bounds[3], frame.height)};
  } else if (!window.empty()) {
    if (window.size() != 4) {
      parameters.Fail(parameters.where(), "\"float cropwindow\" wants x0 x1 y0 y1");
      return;
    }
    const auto pixel = [](double fraction, int size) {
      return static_cast<int>(std::ceil(std::clamp(fraction, 0.0, 1.0) * size));
    };
    crop = {pixel(window[0], frame.width), pixel(window[2], frame.height),
            pixel(window[1], frame.width), pixel(window[3], frame.height)};
  } else {
    return;
  }
  if (crop.x0 >= crop.x1 || crop.y0 >= crop.y1) {
    parameters.Fail(parameters.where(), "the film's crop holds no pixels");
    return;
  }
  frame.crop = crop;
}

/// pbrt models how a sensor turns radiance into values; here values are radiance.
void WarnOfSensor(ParameterReader& parameters, ReadContext& context) {
  const std::string sensor = parameters.String("sensor", "cie1931");
  const double exposure = parameters.Float("exposuretime", 1) * parameters.Float("iso", 100) / 100;
  const double white_balance = parameters.Float("whitebalance", 0);
  if (sensor != "cie1931" || exposure != 1 || white_balance != 0) {
    context.Warn(parameters.where(),
                 "the film's sensor, exposure and white balance are ignored; the image holds "
                 "radiance in scene units");
  }
  if (parameters.Has("maxcomponentvalue")) {
    context.Warn(parameters.Take("maxcomponentvalue")->where,
                 "\"maxcomponentvalue\" is ignored; clamping samples would bias the image");
  }
}

}  // namespace

absl::Status ReadFilm(const std::string& type, ParameterReader& parameters, ReadContext& context) {
  if (!IsOneOf(type, {"rgb", "gbuffer", "spectral"})) {
    return ErrorAt(parameters.where(), StrCat("unknown Film \"", type, "\"; use rgb"));
  }
  if (type != "rgb") {
    context.Warn(parameters.where(), StrCat("Film \"", type,
                                            "\" is read as rgb; ask for more channels by job "
                                            "options"));
    parameters.IgnoreAll();
  }
  FrameDefaults& frame = context.scene.defaults;
  frame.width = parameters.Integer("xresolution", 1280);
  frame.height = parameters.Integer("yresolution", 720);
  if (std::min(frame.width, frame.height) < 1 ||
      std::max(frame.width, frame.height) > kMaxResolution) {
    parameters.Fail(parameters.where(), StrCat("the film has ", frame.width, " x ", frame.height,
                                               " pixels; each must be 1 to ", kMaxResolution));
    frame.width = frame.height = 1;
  }
  ReadCrop(parameters, frame);
  WarnOfSensor(parameters, context);
  parameters.String("filename", "");  // the output is named on the command line
  parameters.Float("diagonal", 35);   // of realistic cameras alone
  parameters.Bool("savefp16", true);
  return parameters.Finish(context.warnings);
}

absl::Status ReadPixelFilter(const std::string& type, ParameterReader& parameters,
                             ReadContext& context) {
  std::string known = type;
  if (type == "sinc") {
    context.Warn(parameters.where(), "PixelFilter \"sinc\" is not supported; mitchell is used");
    parameters.IgnoreAll();
    known = "mitchell";
  }
  const absl::StatusOr<FilterKind> kind = ParseFilterKind(known);
  if (!kind.ok()) {
    return ErrorAt(parameters.where(), StrCat("unknown PixelFilter \"", type,
                                              "\"; use box, triangle, gaussian or mitchell"));
  }
  FilterSpec filter = DefaultFilter(*kind);
  if (known == type) {
    filter.radius_x = parameters.Float("xradius", filter.radius_x);
    filter.radius_y = parameters.Float("yradius", filter.radius_y);
    if (*kind == FilterKind::kGaussian) filter.sigma = parameters.Float("sigma", filter.sigma);
    if (*kind == FilterKind::kMitchell) {
      filter.b = parameters.Float("B", filter.b);
      filter.c = parameters.Float("C", filter.c);
    }
  }
  if (!(std::min({filter.radius_x, filter.radius_y, filter.sigma}) > 0)) {
    parameters.Fail(parameters.where(), "the filter's radius and sigma must be more than 0");
  }
  context.scene.defaults.filter = filter;
  return parameters.Finish(context.warnings);
}

/// pbrt-v4's samplers, and those of this renderer that it has not.
struct SamplerName {
  std::string_view name;
  SamplerKind kind;
  bool substitute = false;  ///< It is another in the file; only the noise differs.
};
constexpr SamplerName kSamplers[] = {
    {"sobol", SamplerKind::kSobol},
    {"paddedsobol", SamplerKind::kSobol},
    {"zsobol", SamplerKind::kSobol},
    {"pmj02bn", SamplerKind::kSobol, true},
    {"independent", SamplerKind::kIndependent},
    {"halton", SamplerKind::kHalton},
    {"halton_plain", SamplerKind::kHaltonPlain},
    {"stratified", SamplerKind::kStratified},
    {"latin_hypercube", SamplerKind::kLatinHypercube},
    {"poisson_disk", SamplerKind::kPoissonDisk},
    {"drand48", SamplerKind::kDrand48},
};

/// Points are Owen-scrambled whatever the file says, but for those of Halton without any scramble.
void ReadRandomization(ParameterReader& parameters, ReadContext& context) {
  SamplerKind& sampler = context.scene.defaults.sampler;
  const std::string randomization = parameters.String("randomization", "fastowen");
  if (randomization == "none" && sampler == SamplerKind::kHalton) {
    sampler = SamplerKind::kHaltonPlain;
  } else if (randomization == "none") {
    context.Warn(parameters.where(),
                 "the sampler is always randomized; an error cannot be "
                 "estimated otherwise");
  } else if (randomization == "permutedigits") {
    context.Warn(parameters.where(),
                 "randomization \"permutedigits\" is not supported; owen is used");
  } else if (!IsOneOf(randomization, {"fastowen", "owen"})) {
    parameters.Fail(parameters.where(),
                    StrCat("unknown randomization \"", randomization, "\"; use owen"));
  }
}

absl::Status ReadSampler(const std::string& type, ParameterReader& parameters,
                         ReadContext& context) {
  FrameDefaults& frame = context.scene.defaults;
  int samples = 16;
  if (type == "stratified") {
    const double grid =
        static_cast<double>(parameters.Integer("xsamples", 4)) * parameters.Integer("ysamples", 4);
    samples = grid >= 1 && grid <= 1e9 ? static_cast<int>(grid) : 0;
    if (!parameters.Bool("jitter", true)) {
      context.Warn(parameters.where(),
                   "\"jitter\" false is ignored: samples are jittered in grids of 4x4");
    }
  } else {
    samples = parameters.Integer("pixelsamples", 16);
  }
  if (samples < 1) {
    parameters.Fail(parameters.where(), "the number of samples per pixel must be 1 to 1e9");
  }
  frame.spp = static_cast<uint32_t>(std::max(samples, 1));
  const auto* known = std::find_if(std::begin(kSamplers), std::end(kSamplers),
                                   [&](const SamplerName& s) { return s.name == type; });
  if (known == std::end(kSamplers)) {
    return ErrorAt(parameters.where(), StrCat("unknown Sampler \"", type, "\"; use sobol"));
  }
  frame.sampler = known->kind;
  if (known->substitute) {
    context.Warn(parameters.where(),
                 StrCat("Sampler \"", type, "\" is not supported; sobol is used"));
  }
  ReadRandomization(parameters, context);
  parameters.Integer("seed", 0);  // the job's own seed counts
  return parameters.Finish(context.warnings);
}

absl::Status ReadIntegrator(const std::string& type, ParameterReader& parameters,
                            ReadContext& context) {
  const int max_depth = parameters.Integer("maxdepth", 5);
  if (max_depth < 0) {
    parameters.Fail(parameters.where(), "\"integer maxdepth\" must not be negative");
  }
  context.scene.defaults.max_depth = std::clamp(max_depth, 0, 100000);
  if (!IsOneOf(type, {"path", "volpath"})) {
    context.Warn(parameters.where(),
                 StrCat("Integrator \"", type, "\" is not supported; path is used"));
    parameters.IgnoreAll();
  }
  if (parameters.Bool("regularize", false)) {
    context.Warn(parameters.where(), "\"regularize\" is ignored; it would bias the image");
  }
  parameters.String("lightsampler", "");  // changes the noise alone
  return parameters.Finish(context.warnings);
}

}  // namespace strata
