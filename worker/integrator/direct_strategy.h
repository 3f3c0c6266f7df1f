#pragma once

namespace strata {

/// How light that falls directly on a vertex is found. All have the same expectation as long as no
/// light is a delta light, and no environment is compensated (LightOptions), which leaves a part of
/// it to BSDF sampling; the single ones exist to test the sum.
enum class DirectStrategy { kMis, kLightOnly, kBsdfOnly };

}  // namespace strata
