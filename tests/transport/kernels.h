#pragma once

#include <memory>

#include "tests/transport/test_scene.h"

// The fast kernel beside the reference kernel.

namespace strata {

/// The frame of `spec`, of each replicate the samples of `range`, by `kernel`.
Partial RenderBy(const std::shared_ptr<const Scene>& scene, JobSpec spec, KernelKind kernel,
                 SampleRange range);

/// The share of samples of which all channels agree between the kernels within `tolerance`,
/// relative to the greater of the value and 1e-3.
double AgreeingShare(const std::shared_ptr<const Scene>& scene, const JobSpec& spec,
                     double tolerance);

}  // namespace strata
