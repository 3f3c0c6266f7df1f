#pragma once

#include "common/pixel_layout.h"
#include "common/status.h"
#include "common/unit.h"

namespace strata {

/// INVALID_ARGUMENT with the reason unless `partial` can be what rendering `unit` gives: its
/// pixels, layout and counts, vectors of the right size, finite doubles, and no negative second
/// moments.
absl::Status CheckPartial(const Partial& partial, const WorkUnit& unit, const PixelLayout& layout);

}  // namespace strata
