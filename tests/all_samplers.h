#pragma once

#include "common/job.h"

namespace strata {

inline constexpr SamplerKind kAllSamplers[] = {
    SamplerKind::kSobol,       SamplerKind::kIndependent, SamplerKind::kHalton,
    SamplerKind::kHaltonPlain, SamplerKind::kStratified,  SamplerKind::kLatinHypercube,
    SamplerKind::kPoissonDisk, SamplerKind::kDrand48};

}  // namespace strata
