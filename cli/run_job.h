#pragma once

#include "cli/farm_client.h"
#include "cli/interrupt.h"
#include "cli/job_options.h"
#include "cli/progress.h"
#include "cli/report.h"

namespace strata {

/// Shows what a person should know of a job before it is sent: what was rounded, what the scene has
/// that is not supported.
void ShowNotes(const ResolvedJob& job, bool quiet, Console& console);

/// Uploads what the coordinator lacks and submits the job; safe to be sent twice.
absl::StatusOr<JobId> SubmitJob(FarmClient& farm, const ResolvedJob& job, ProgressStyle style,
                                Console& console);

/// What Ctrl-C means to a command that follows a job.
enum class OnInterrupt {
  kCancel,  ///< The job ends; what is merged is written.
  kDetach,  ///< The job goes on without an audience.
};

/// Follows a job to its end and finishes it (FinishJob). kInterrupted after Ctrl-C.
absl::StatusOr<ExitStatus> FollowToEnd(FarmClient& farm, const JobId& job,
                                       const ImageOutput& output, ProgressStyle style,
                                       const InterruptWatch& interrupts, OnInterrupt on_interrupt,
                                       Console& console);

}  // namespace strata
