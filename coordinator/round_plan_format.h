#pragma once

#include <string>
#include <string_view>

#include "common/status.h"
#include "coordinator/round_plan.h"

namespace strata {

/// The durable form of a round plan; docs/film-format.md describes it.
std::string EncodeRoundPlan(const RoundPlan& plan);

/// DATA_LOSS with the reason when the bytes are damaged or of another version.
absl::StatusOr<RoundPlan> DecodeRoundPlan(std::string_view bytes);

}  // namespace strata
