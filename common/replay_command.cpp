#include "common/replay_command.h"

#include <absl/strings/ascii.h>
#include <fmt/format.h>

#include <algorithm>

namespace strata {
namespace {

/// The scene and, where it lies in a folder of its bundle, the bundle's root; its options.
std::string SceneArguments(const JobSpec& spec) {
  const std::string& scene = spec.bundle.scene;
  const bool like_an_option = scene.rfind('-', 0) == 0;
  const bool in_folder = scene.find('/') != std::string::npos;
  std::string text =
      ShellQuoted((like_an_option ? "./" : "") + scene) + (in_folder ? " --root ." : "");
  const SceneOptions& options = spec.bundle.options;
  if (!options.environment.empty()) text += " --env=" + ShellQuoted(options.environment);
  if (!options.camera.empty()) text += " --camera=" + ShellQuoted(options.camera);
  if (options.light_selection != LightSelection::kTree)
    text += fmt::format(" --light-selection {}", ToString(options.light_selection));
  return text;
}

/// For --filter; numbers are written so that they are read back to the last bit.
std::string FilterArgument(const FilterSpec& filter) {
  std::string text =
      fmt::format("{}:{},{}", ToString(filter.kind), filter.radius_x, filter.radius_y);
  if (filter.kind == FilterKind::kGaussian) text += fmt::format(",{}", filter.sigma);
  if (filter.kind == FilterKind::kMitchell) text += fmt::format(",{},{}", filter.b, filter.c);
  return text;
}

}  // namespace

std::string ReplayCommand(const JobSpec& spec, int x, int y, uint32_t replicate, uint32_t sample) {
  std::string command = fmt::format(
      "strata replay {} --pixel {},{} --replicate {} --sample {} --seed {} --frame {} "
      "--resolution {}x{} --max-depth {} --sampler {} --filter {}",
      SceneArguments(spec), x, y, replicate, sample, spec.seed, spec.frame, spec.width, spec.height,
      spec.max_depth, ToString(spec.sampler), FilterArgument(spec.filter));
  if (spec.strategy != DirectStrategy::kMis)
    command += fmt::format(" --strategy {}", ToString(spec.strategy));
  if (spec.mis_beta != JobSpec().mis_beta) command += fmt::format(" --mis-beta {}", spec.mis_beta);
  if (spec.routines != SamplingRoutines::kPreserving)
    command += fmt::format(" --routines {}", ToString(spec.routines));
  if (spec.roulette != RouletteKind::kThroughput)
    command += fmt::format(" --roulette {}", ToString(spec.roulette));
  return command;
}

std::string CheckCommand(const JobSpec& spec) { return "strata check " + SceneArguments(spec); }

std::string ShellQuoted(std::string_view word) {
  constexpr std::string_view kHarmless = "_./,:=+-@%";
  const bool plain = !word.empty() && std::all_of(word.begin(), word.end(), [&](unsigned char c) {
    return absl::ascii_isalnum(c) || kHarmless.find(static_cast<char>(c)) != kHarmless.npos;
  });
  if (plain) return std::string(word);
  // Nothing is special within single quotes but they themselves.
  std::string quoted = "'";
  for (const char c : word) {
    if (c == '\'') {
      quoted += "'\\''";
    } else {
      quoted += c;
    }
  }
  return quoted + "'";
}

}  // namespace strata
