#pragma once

#include <variant>

#include "worker/sampling/block_samplers.h"
#include "worker/sampling/drand48.h"
#include "worker/sampling/halton.h"

namespace strata {

/// Any sampler but the two that kernels are compiled for, sobol and independent, as key.kind says.
/// One kernel for all of these is enough: they are there to be compared with.
class PatternSampler {
 public:
  explicit PatternSampler(const SampleKey& key);
  void StartSample(uint32_t index) {
    std::visit([&](auto& sampler) { sampler.StartSample(index); }, sampler_);
  }
  /// Not inline: kernels would have all of them at each of their calls.
  Vec2f Get2D(uint32_t pair) const;

 private:
  using Sampler = std::variant<HaltonSampler, PlainHaltonSampler, StratifiedSampler,
                               LatinHypercubeSampler, PoissonDiskSampler, Drand48Sampler>;
  static Sampler Make(const SampleKey& key);

  Sampler sampler_;
};

}  // namespace strata
