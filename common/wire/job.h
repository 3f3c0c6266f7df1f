#pragma once

#include "common/job.h"
#include "strata/v1/job.pb.h"

// Jobs as strata.v1 messages and back.

namespace strata::wire {

void ToWire(const PixelRect& rect, v1::PixelRect* message);
PixelRect FromWire(const v1::PixelRect& message);

/// `with_files` false leaves the bundle's files out, for answers where they would only be a burden.
void ToWire(const JobSpec& spec, v1::JobSpec* message, bool with_files = true);

/// Checks what a plain struct cannot express (lengths of digests, unknown enum values); whether the
/// spec makes sense is for ValidateJobSpec. Errors name the field from "spec" on.
absl::StatusOr<JobSpec> FromWire(const v1::JobSpec& message);

}  // namespace strata::wire
