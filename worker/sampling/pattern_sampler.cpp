#include "worker/sampling/pattern_sampler.h"

namespace strata {

PatternSampler::PatternSampler(const SampleKey& key) : sampler_(Make(key)) {}

PatternSampler::Sampler PatternSampler::Make(const SampleKey& key) {
  switch (key.kind) {
    case SamplerKind::kHaltonPlain:
      return PlainHaltonSampler(key);
    case SamplerKind::kStratified:
      return StratifiedSampler(key);
    case SamplerKind::kLatinHypercube:
      return LatinHypercubeSampler(key);
    case SamplerKind::kPoissonDisk:
      return PoissonDiskSampler(key);
    case SamplerKind::kDrand48:
      return Drand48Sampler(key);
    case SamplerKind::kHalton:
    case SamplerKind::kSobol:        // These have
    case SamplerKind::kIndependent:  // kernels of their own.
      break;
  }
  return HaltonSampler(key);
}

Vec2f PatternSampler::Get2D(uint32_t pair) const {
  return std::visit([&](const auto& sampler) { return sampler.Get2D(pair); }, sampler_);
}

}  // namespace strata
