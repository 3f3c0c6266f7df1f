#include "worker/integrator/hemisphere_strategy.h"

#include <cmath>

#include "worker/sampling/routines.h"
#include "worker/sampling/warp.h"

namespace strata {
namespace {

/// Halves a uniform number: what it says of which half it lies in is used up.
bool TakeHalf(float* u) {
  const bool upper = *u >= 0.5f;
  *u = 2 * *u - (upper ? 1 : 0);
  return upper;
}

}  // namespace

std::optional<BsdfSample> SampleHemisphere(DirectStrategy strategy, SamplingRoutines routines,
                                           const Bsdf& bsdf, Vec3f wo, float u_lobe, Vec2f u) {
  if (IsDelta(bsdf)) return Sample(bsdf, wo, u_lobe, u);
  float chance = 1;  // Of what is done below.
  if (HasDelta(bsdf)) {
    chance = 0.5f;
    if (TakeHalf(&u_lobe)) {
      std::optional<BsdfSample> sample = Sample(bsdf, wo, u_lobe, u);
      // What is not delta is for the other half.
      if (!sample || !sample->delta) return std::nullopt;
      sample->weight *= 1 / chance;
      return sample;
    }
  }
  // Media have no cosine.
  const bool uniform =
      strategy == DirectStrategy::kUniform || std::holds_alternative<PhaseFunction>(bsdf);
  BsdfSample sample;
  sample.wi =
      uniform ? SampleUniformHemisphereBy(routines, u) : SampleCosineHemisphereBy(routines, u);
  sample.pdf = chance * (uniform ? UniformHemispherePdf() : CosineHemispherePdf(sample.wi.z));
  bool below = wo.z < 0;
  if (Transmits(bsdf)) {
    sample.pdf *= 0.5f;
    if (TakeHalf(&u_lobe)) {
      sample.transmission = true;
      below = !below;
    }
  }
  if (below) sample.wi.z = -sample.wi.z;
  if (!(sample.pdf > 0)) return std::nullopt;
  sample.weight = Eval(bsdf, wo, sample.wi) * (1 / sample.pdf);
  return sample;
}

}  // namespace strata
