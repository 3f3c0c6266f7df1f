#include "cli/report.h"

#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>
#include <unistd.h>

#include <filesystem>

#include "cli/events.h"
#include "cli/format.h"
#include "cli/scene_summary.h"
#include "common/image_file.h"

namespace strata {
namespace {

namespace fs = std::filesystem;

/// Enough to start a search from; the rest is in `strata logs`.
constexpr size_t kLogLinesShown = 5;

bool IsPng(const fs::path& path) { return path.extension() == ".png"; }

/// How a job that did not end well is told, and what to do.
std::string Complaint(const JobStatus& status) {
  const std::string why = status.message.empty() ? "" : ": " + status.message;
  switch (status.state) {
    case JobState::kFailed:
      return absl::StrCat(status.id, " failed", why);
    case JobState::kCancelled:
      return absl::StrCat(status.id, " was cancelled", why);
    default:
      return absl::StrCat(status.id, ": ", status.nonfinite,
                          " samples were NaN or infinite; they count as zero and their pixels are "
                          "flagged, so look at the flags.Y layer and replay them");
  }
}

/// Shows what the log says of a job that did not end well: the commands that replay its failures.
void ShowTroubles(FarmClient& client, const JobStatus& status, Console& console) {
  const absl::StatusOr<std::vector<LogLine>> log = client.Logs(status.id);
  if (!log.ok()) return;  // The complaint itself has been told already.
  size_t shown = 0;
  for (const LogLine& line : *log) {
    if (line.level == "info") continue;
    if (++shown > kLogLinesShown) break;
    console.Note("  " + Printable(line.text));
  }
}

/// "worst tiles: ±12 % at 32,64; ..."
std::string WorstTiles(const JobStatus& status) {
  std::vector<std::string> tiles;
  for (const TileError& tile : status.worst_tiles) {
    tiles.push_back(absl::StrFormat("±%s at %d,%d", FormatPercent(tile.rel_error), tile.pixels.x0,
                                    tile.pixels.y0));
  }
  return "worst tiles: " + absl::StrJoin(tiles, "; ");
}

/// Whether a job's target was met; empty for a job without one.
std::string TargetLine(const JobStatus& status) {
  const double value = status.spec.target_value;
  const std::string met = TargetMet(status) ? "target met" : "target not met within --spp";
  switch (status.spec.target) {
    case TargetKind::kSamples:
      return "";
    case TargetKind::kTime:
      return absl::StrFormat("rendered for at most %s in %d rounds", FormatDuration(value),
                             status.rounds);
    case TargetKind::kRmse:
      return absl::StrFormat("%s: --rmse %g after %d rounds", met, value, status.rounds);
    case TargetKind::kRelativeError:
      break;
  }
  return absl::StrFormat("%s: %s of pixels within ±%s, as their surroundings show, after %d rounds",
                         met, FormatPercent(status.target_share), FormatPercent(value),
                         status.rounds);
}

/// Fetches a job's image, if there is one and it is wanted, and returns the paths of its files.
absl::StatusOr<std::vector<std::string>> SaveImage(FarmClient& client, const JobStatus& status,
                                                   const ImageOutput& output) {
  if (output.path.empty() || status.samples == 0) return std::vector<std::string>();
  STRATA_ASSIGN_OR_RETURN(const ImageLayers image, client.FetchImage(status.id));
  return WriteImage(output, image);
}

/// What came of a job, in a few lines for people.
std::vector<std::string> ReportLines(const JobStatus& status,
                                     const std::vector<std::string>& files) {
  std::vector<std::string> lines;
  for (const std::string& file : files) lines.push_back(file);
  std::string work = absl::StrFormat("%s samples (%s per pixel) in %s", FormatCount(status.samples),
                                     FormatCount(status.spp_mean), FormatDuration(status.wall_s));
  if (status.render_s > 0) {
    absl::StrAppend(&work, ", ", FormatCount(status.samples / status.render_s), " samples/s");
  }
  lines.push_back(work);
  if (status.background_pixels > 0) {
    lines.push_back(BackgroundLine(status.background_pixels, status.spec.crop.Pixels()));
  }
  if (status.rel_error > 0) {
    lines.push_back(absl::StrFormat("99 %% of pixels are within ±%s (95 %% confidence)",
                                    FormatPercent(status.rel_error)));
  }
  const bool claims_interval = ClaimsInterval(status.spec.sampler);
  if (!status.worst_tiles.empty() && claims_interval) lines.push_back(WorstTiles(status));
  if (const std::string target = TargetLine(status); !target.empty()) lines.push_back(target);
  if (!claims_interval) {
    lines.push_back(absl::StrFormat(
        "no interval is claimed: the replicates of %s are not independent of each other",
        std::string(ToString(status.spec.sampler))));
  } else if (status.flagged > 0) {
    lines.push_back(absl::StrFormat("%s of pixels are flagged: their interval may be too narrow",
                                    FormatPercent(status.flagged)));
  }
  if (status.state == JobState::kDone) lines.push_back(status.result.ToString());
  return lines;
}

}  // namespace

CLI::Option* AddOutputOptions(CLI::App* command, ImageOutput& output) {
  command->add_flag("--png", output.png, "Write a .png for looking beside the .exr");
  return command
      ->add_option("-o,--output", output.path,
                   "Where the image goes: .exr with all error layers, or .png for looking")
      ->type_name("FILE");
}

absl::Status CheckImageOutput(const ImageOutput& output) {
  if (output.path.empty()) {
    return output.png
               ? absl::InvalidArgumentError("--png needs an image to lie beside: give -o out.exr")
               : absl::OkStatus();
  }
  const fs::path path(output.path);
  if (path.extension() != ".exr" && !IsPng(path)) {
    return absl::InvalidArgumentError(
        absl::StrCat("-o: ", output.path, " ends in neither .exr nor .png, give one that does"));
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) {
    return absl::InvalidArgumentError(
        absl::StrCat("-o: there is no directory ", folder.string(), ", make it first"));
  }
  if (access(folder.c_str(), W_OK) != 0 || fs::is_directory(path, ignored)) {
    return absl::InvalidArgumentError(
        absl::StrCat("-o: ", output.path, " cannot be written, give another path"));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<std::string>> WriteImage(const ImageOutput& output,
                                                    const ImageLayers& image) {
  if (IsPng(output.path)) {
    STRATA_RETURN_IF_ERROR(WritePng(output.path, image));
    return std::vector{output.path};
  }
  STRATA_RETURN_IF_ERROR(WriteExr(output.path, image));
  std::vector<std::string> written = {output.path};
  if (output.png) {
    written.push_back(fs::path(output.path).replace_extension(".png").string());
    STRATA_RETURN_IF_ERROR(WritePng(written.back(), image));
  }
  return written;
}

absl::StatusOr<ExitStatus> FinishJob(FarmClient& client, const JobStatus& status,
                                     const ImageOutput& output, bool json, Console& console) {
  const bool finite = status.state == JobState::kDone && status.nonfinite == 0;
  if (!finite) {
    console.Error(Complaint(status));
    ShowTroubles(client, status, console);
  }
  // What came of the job is told whether or not its image can be written.
  const absl::StatusOr<std::vector<std::string>> files = SaveImage(client, status, output);
  if (json) {
    console.Result(DoneEvent(status));
  } else {
    for (const std::string& line : ReportLines(status, files.value_or(std::vector<std::string>())))
      console.Result(line);
  }
  STRATA_RETURN_IF_ERROR(files.status());
  return finite && TargetMet(status) ? ExitStatus::kDone : ExitStatus::kFailed;
}

}  // namespace strata
