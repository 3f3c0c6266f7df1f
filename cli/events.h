#pragma once

#include <string>
#include <vector>

#include "common/report.h"

// What --json prints: one object per line for a job that is followed, one array or object for
// lists. The keys are fixed (docs/command-line.md), since scripts read them.

namespace strata {

/// {"event":"progress",...}
std::string ProgressEvent(const JobStatus& status);
/// {"event":"done",...}, the last line of a followed job.
std::string DoneEvent(const JobStatus& status);

/// A job after a command that changed it: {"job","state","priority"}.
std::string ControlJson(const JobStatus& status);
/// {"job","deleted":true}
std::string DeletedJson(const JobId& job);

std::string JobsJson(const std::vector<JobStatus>& jobs);
std::string WorkersJson(const std::vector<WorkerStatus>& workers);
std::string LogsJson(const std::vector<LogLine>& lines);

/// Whether the job came to its end with all samples it was to take.
bool TargetMet(const JobStatus& status);

}  // namespace strata
