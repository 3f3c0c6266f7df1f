#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/console.h"
#include "cli/exit_status.h"
#include "cli/farm_client.h"

namespace strata {

/// Where a command leaves the image.
struct ImageOutput {
  std::string path;  ///< .exr or .png; empty: nowhere.
  bool png = false;  ///< A .png beside the .exr as well.
};

/// Adds -o and --png; returns -o, so that a command may require it.
CLI::Option* AddOutputOptions(CLI::App* command, ImageOutput& output);
/// INVALID_ARGUMENT unless the path can be written to: found out before the work, not after.
absl::Status CheckImageOutput(const ImageOutput& output);
/// Writes the files and returns their paths.
absl::StatusOr<std::vector<std::string>> WriteImage(const ImageOutput& output,
                                                    const ImageLayers& image);

/// The end of a followed job: fetches and writes its image if it has one, prints the report (or the
/// "done" event) and says what the process should end with.
absl::StatusOr<ExitStatus> FinishJob(FarmClient& client, const JobStatus& status,
                                     const ImageOutput& output, bool json, Console& console);

}  // namespace strata
