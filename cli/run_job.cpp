#include "cli/run_job.h"

#include <absl/strings/str_format.h>

#include <random>

#include "cli/follow.h"
#include "cli/format.h"

namespace strata {
namespace {

/// 128 random bits: two submissions of people who never met do not share an id.
std::string NewRequestId() {
  std::random_device device;
  return absl::StrFormat("%08x%08x%08x%08x", device(), device(), device(), device());
}

/// The image so far of a job that was stopped by its owner, and words about it.
absl::StatusOr<ExitStatus> FinishInterrupted(FarmClient& farm, const JobStatus& status,
                                             const ImageOutput& output, Console& console) {
  std::string told = "stopped";
  if (!output.path.empty() && status.samples > 0) {
    STRATA_ASSIGN_OR_RETURN(const ImageLayers image, farm.FetchImage(status.id));
    STRATA_ASSIGN_OR_RETURN(const std::vector<std::string> files, WriteImage(output, image));
    absl::StrAppend(&told, "; the image so far (", FormatPercent(status.fraction),
                    " of the samples) is in ", files.front());
  } else {
    told += "; no image was written";
  }
  console.Note(told);
  return ExitStatus::kInterrupted;
}

}  // namespace

void ShowNotes(const ResolvedJob& job, bool quiet, Console& console) {
  if (quiet) return;
  for (const std::string& warning : job.warnings) console.Warning(warning);
  for (const std::string& note : job.notes) console.Note(note);
}

absl::StatusOr<JobId> SubmitJob(FarmClient& farm, const ResolvedJob& job, ProgressStyle style,
                                Console& console) {
  const bool live = console.live() && !style.json && !style.quiet;
  const auto tell = [&](uint64_t sent, uint64_t total) {
    if (live) {
      console.Redraw(
          absl::StrFormat("sending the scene: %s of %s", FormatBytes(sent), FormatBytes(total)));
    }
  };
  STRATA_RETURN_IF_ERROR(farm.Upload(job.spec.bundle, job.root, tell, job.elsewhere));
  console.Clear();
  return farm.Submit(job.spec, NewRequestId());
}

absl::StatusOr<ExitStatus> FollowToEnd(FarmClient& farm, const JobId& job,
                                       const ImageOutput& output, ProgressStyle style,
                                       const InterruptWatch& interrupts, OnInterrupt on_interrupt,
                                       Console& console) {
  absl::Status cancelled;
  absl::StatusOr<JobStatus> status = [&] {
    const auto display = MakeProgressDisplay(style, console);
    return FollowJob(farm, job, *display, interrupts, [&] {
      if (on_interrupt == OnInterrupt::kDetach) return false;
      cancelled = farm.Cancel(job);
      return cancelled.ok();
    });
  }();
  STRATA_RETURN_IF_ERROR(cancelled);
  STRATA_RETURN_IF_ERROR(status.status());
  const bool ended_by_itself = IsFinal(status->state) && status->state != JobState::kCancelled;
  if (!interrupts.interrupted() || ended_by_itself) {
    return FinishJob(farm, *status, output, style.json, console);
  }
  if (on_interrupt == OnInterrupt::kCancel) {
    return FinishInterrupted(farm, *status, output, console);
  }
  console.Note(absl::StrCat(job, " goes on; 'strata watch ", job,
                            "' follows it again, 'strata cancel ", job, "' ends it"));
  return ExitStatus::kInterrupted;
}

}  // namespace strata
