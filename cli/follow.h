#pragma once

#include <functional>

#include "cli/farm_client.h"
#include "cli/interrupt.h"
#include "cli/progress.h"

namespace strata {

/// Follows `job` to its end, showing every status. Returns its last status: a final one, or, after
/// an interrupt, the one it had then. `on_interrupt` is called once, at the first interrupt; true:
/// go on following (the job was told to end), false: leave the job alone and return.
/// A broken stream is taken up again while the server comes back within a few seconds; then
/// UNAVAILABLE.
absl::StatusOr<JobStatus> FollowJob(FarmClient& client, const JobId& job, ProgressDisplay& display,
                                    const InterruptWatch& interrupts,
                                    const std::function<bool()>& on_interrupt);

}  // namespace strata
