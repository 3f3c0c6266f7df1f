#pragma once

#include <optional>

#include "common/job.h"
#include "worker/bsdf/bsdf.h"

namespace strata {

/// A direction drawn without regard to the BSDF: kCosine by the cosine (PBRT A.5.3), or kUniform by
/// solid angle (PBRT A.5.2), by the `routines`, over the hemisphere of wo, over both where light
/// may pass through. Delta reflection, which no such direction meets, is followed instead where it
/// is all there is, and every other time where it is a part. An unbiased estimator as Sample is,
/// with weight f |cos theta_i| / pdf.
std::optional<BsdfSample> SampleHemisphere(DirectStrategy strategy, SamplingRoutines routines,
                                           const Bsdf& bsdf, Vec3f wo, float u_lobe, Vec2f u);

}  // namespace strata
