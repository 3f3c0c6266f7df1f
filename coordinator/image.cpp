#include "coordinator/image.h"

#include <fmt/format.h>

#include <algorithm>

namespace strata {

ImageBuilder::ImageBuilder(const JobSpec& spec, double widening)
    : widening_(widening), claims_interval_(ClaimsInterval(spec.sampler)) {
  const std::vector<std::string> plain = PlainChannelNames(spec.channels);
  plain_ = plain.size();
  image_.full_width = spec.width;
  image_.full_height = spec.height;
  image_.crop = spec.crop;
  image_.channels = {"R", "G", "B"};
  image_.channels.insert(image_.channels.end(), plain.begin(), plain.end());
  for (const std::string_view layer : {"stderr", "ci95", "variance"}) {
    if (!claims_interval_ && layer != "variance") continue;
    for (const char* colour : {"R", "G", "B"}) {
      image_.channels.push_back(fmt::format("{}.{}", layer, colour));
    }
  }
  image_.channels.insert(image_.channels.end(), {"samples.Y", "flags.Y"});
  image_.values.resize(static_cast<size_t>(spec.crop.Pixels()) * image_.channels.size());
}

void ImageBuilder::Fill(const EstimateInput& input, const std::vector<double>& plain) {
  const std::vector<PixelEstimate> estimates = Estimate(input);
  const PixelRect& rect = input.wanted;
  const auto put = [](const double* from, size_t count, float* to, double scale = 1) {
    return std::transform(from, from + count, to,
                          [&](double v) { return static_cast<float>(v * scale); });
  };
  size_t i = 0;
  for (int y = rect.y0; y < rect.y1; ++y) {
    const size_t pixel = static_cast<size_t>(y - image_.crop.y0) * image_.crop.Width() +
                         static_cast<size_t>(rect.x0 - image_.crop.x0);
    float* out = &image_.values[pixel * image_.channels.size()];
    for (int x = rect.x0; x < rect.x1; ++x, ++i) {
      const PixelEstimate& estimate = estimates[i];
      out = put(estimate.mean, kColours, out);
      out = put(plain.data() + i * plain_, plain_, out);
      if (claims_interval_) {
        out = put(estimate.standard_error, kColours, out);
        out = put(estimate.ci95, kColours, out, widening_);
      }
      out = put(estimate.variance, kColours, out);
      *out++ = static_cast<float>(estimate.samples);
      *out++ = static_cast<float>(estimate.flags);
    }
  }
}

ImageLayers ImageBuilder::Finish(std::vector<std::pair<std::string, std::string>> metadata) {
  image_.metadata = std::move(metadata);
  return std::move(image_);
}

std::vector<double> GatherPlain(const Film& film, const PixelRect& wanted) {
  const PixelLayout& layout = film.geometry().layout;
  std::vector<double> plain;
  plain.reserve(static_cast<size_t>(wanted.Pixels()) * static_cast<size_t>(layout.plain));
  for (int y = wanted.y0; y < wanted.y1 && layout.plain > 0; ++y) {
    for (int x = wanted.x0; x < wanted.x1; ++x) {
      const double* values = film.At(x, y).values + layout.Plain(0);
      plain.insert(plain.end(), values, values + layout.plain);
    }
  }
  return plain;
}

namespace {

std::string FilterText(const FilterSpec& filter) {
  std::string text =
      fmt::format("{}:{}x{}", ToString(filter.kind), filter.radius_x, filter.radius_y);
  if (filter.kind == FilterKind::kGaussian) text += fmt::format(",sigma={}", filter.sigma);
  if (filter.kind == FilterKind::kMitchell) text += fmt::format(",b={},c={}", filter.b, filter.c);
  return text;
}

}  // namespace

std::vector<std::pair<std::string, std::string>> ImageMetadata(const JobStatus& status,
                                                               const std::string& build) {
  const JobSpec& spec = status.spec;
  std::vector<std::pair<std::string, std::string>> metadata = {
      {"name", spec.name},
      {"scene", spec.bundle.scene},
      {"sceneDigest", BundleDigest(spec.bundle).ToString()},
      {"resolution", fmt::format("{}x{}", spec.width, spec.height)},
      {"crop", fmt::format("{},{},{},{}", spec.crop.x0, spec.crop.y0, spec.crop.x1, spec.crop.y1)},
      {"spp", std::to_string(spec.spp)},
      {"allocation", std::string(ToString(spec.allocation))},
      {"target", spec.target == TargetKind::kSamples
                     ? "samples"
                     : fmt::format("{}:{}", ToString(spec.target), spec.target_value)},
      {"rounds", std::to_string(status.rounds)},
      {"interval", !ClaimsInterval(spec.sampler)     ? "none claimed"
                   : status.state == JobState::kDone ? "at this count"
                                                     : "at all times"},
      {"maxDepth", std::to_string(spec.max_depth)},
      {"sampler", std::string(ToString(spec.sampler))},
      {"strategy", std::string(ToString(spec.strategy))},
      {"misBeta", fmt::format("{}", spec.mis_beta)},
      {"routines", std::string(ToString(spec.routines))},
      {"lightSelection", std::string(ToString(spec.bundle.options.light_selection))},
      {"roulette", std::string(ToString(spec.roulette))},
      {"kernel", std::string(ToString(spec.kernel))},
      {"filter", FilterText(spec.filter)},
      {"tile", std::to_string(spec.tile)},
      {"seed", std::to_string(spec.seed)},
      {"frame", std::to_string(spec.frame)},
      {"reproducible", spec.reproducible ? "true" : "false"},
      {"build", build},
      {"state", std::string(ToString(status.state))},
      {"samples", std::to_string(status.samples)},
      {"rays", std::to_string(status.rays)},
      {"nonfinite", std::to_string(status.nonfinite)},
      {"replicates", std::to_string(kReplicates)},
  };
  const SceneOptions& options = spec.bundle.options;
  if (!options.environment.empty()) metadata.emplace_back("environment", options.environment);
  if (!options.camera.empty()) metadata.emplace_back("camera", options.camera);
  if (status.state == JobState::kDone) metadata.emplace_back("digest", status.result.ToString());
  return metadata;
}

}  // namespace strata
