#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "common/job.h"
#include "common/status.h"
#include "worker/scene/scene_file.h"

namespace strata {

/// What the command line says of a job. What is not set comes from the scene file, then from
/// JobSpec's defaults.
struct JobOptions {
  std::string scene;  ///< The pbrt-v4 or glTF file, as typed.
  std::optional<std::string> root;
  std::optional<uint64_t> spp;
  std::optional<std::string> resolution, crop;
  std::optional<int> max_depth;
  std::optional<std::string> sampler, strategy, light_selection, routines, roulette;
  std::optional<std::string> kernel, filter;
  std::optional<double> mis_beta;
  std::optional<int> tile;
  std::optional<uint64_t> seed;
  std::optional<uint32_t> frame;
  std::optional<std::string> channels;
  std::optional<bool> reproducible;
  std::optional<std::string> name;
  std::optional<int> priority;
  std::optional<std::string> allocation;
  std::optional<std::string> error, rmse, time;
  std::optional<std::string> environment;  ///< An image, as typed.
  std::optional<std::string> camera;
  std::optional<std::string> integrator;  ///< Of a later version, if it was given.
};

/// Adds SCENE and all job options to `command`; they are written to `options` when it is parsed.
void AddJobOptions(CLI::App* command, JobOptions& options);
/// Adds SCENE and --root alone.
void AddSceneOptions(CLI::App* command, JobOptions& options);

/// Where a scene lies: the directory its bundle is made of, and the main file in it.
struct ScenePath {
  std::filesystem::path root;  ///< Absolute.
  std::string scene;           ///< Relative to root, '/' separated.
  std::string typed_root;      ///< What leads from the working directory to root, or is absolute.

  /// `message` with the bundle path it starts with, if it does, as a path the user can open.
  std::string Located(const std::string& message) const;
  /// A file of the bundle as a path the user can open.
  std::filesystem::path Typed(const std::string& bundle_path) const;
  DirectorySource Source() const { return DirectorySource(root, elsewhere); }

  FilesElsewhere elsewhere;  ///< What the command line names outside of root.
  SceneOptions options;
};
absl::StatusOr<ScenePath> FindScene(const JobOptions& options);

/// A scene read for a command.
struct LoadedScene {
  ScenePath path;
  SceneFile file;
};
/// Checks the options, so that a typing error does not cost a minute, then reads. Errors are
/// INVALID_ARGUMENT, one line "file:line: what is wrong, what to do".
absl::StatusOr<LoadedScene> ReadScene(const JobOptions& options);

/// All of a job but its bundle. `notes` tells what was rounded.
absl::StatusOr<JobSpec> ResolveJobSpec(const JobOptions& options, const FrameDefaults& defaults,
                                       std::vector<std::string>* notes);

/// A job ready to be submitted.
struct ResolvedJob {
  JobSpec spec;
  std::filesystem::path root;      ///< Where the bundle's files are,
  FilesElsewhere elsewhere;        ///< but for these.
  std::vector<std::string> notes;  ///< What a person should know: what was rounded, what is biased.
  std::vector<std::string> warnings;  ///< Of the scene, "file:line: warning: ...".
};
/// INVALID_ARGUMENT where an option or an image of the scene is bad.
absl::StatusOr<ResolvedJob> ResolveJob(const JobOptions& options, const LoadedScene& loaded);
/// Reads the scene as well.
absl::StatusOr<ResolvedJob> ResolveJob(const JobOptions& options);

/// "scene.pbrt:12: warning: ...", the file as the user can open it.
std::string WarningLine(const ScenePath& path, const SceneWarning& warning);

// The values of single options. INVALID_ARGUMENT says what was given and what is wanted.

struct Resolution {
  int width = 0, height = 0;
};
absl::StatusOr<Resolution> ParseResolution(const std::string& text);  ///< "1280x720"
absl::StatusOr<PixelRect> ParseCrop(const std::string& text);         ///< "x0,y0,x1,y1"
/// "gaussian" has pbrt-v4's radius; "gaussian:2" sets both radii, "gaussian:2,1" each,
/// "gaussian:2,1,0.5" sigma as well, "mitchell:2,2,0.5,0.25" B and C.
absl::StatusOr<FilterSpec> ParseFilter(const std::string& text);
absl::StatusOr<double> ParseRelativeError(const std::string& text);    ///< "0.02", "2%"
absl::StatusOr<double> ParseRmse(const std::string& text);             ///< "0.001"
absl::StatusOr<double> ParseTime(const std::string& text);             ///< "90", "90s", "15m", "2h"
absl::StatusOr<ExtraChannels> ParseChannels(const std::string& text);  ///< "alpha,depth"

}  // namespace strata
