#include "tests/transport/kernels.h"

#include <gtest/gtest.h>

#include <cmath>

namespace strata {

Partial RenderBy(const std::shared_ptr<const Scene>& scene, JobSpec spec, KernelKind kernel,
                 SampleRange range) {
  spec.kernel = kernel;
  const auto renderer = Renderer::Create(scene, spec);
  EXPECT_TRUE(renderer.ok()) << renderer.status();
  RenderPool pool(2);
  return *(*renderer)->Render({{}, spec.crop, {range}}, pool);
}

double AgreeingShare(const std::shared_ptr<const Scene>& scene, const JobSpec& spec,
                     double tolerance) {
  int64_t samples = 0, agreeing = 0;
  for (uint32_t index = 0; index < spec.spp / kReplicates; ++index) {
    // Units of one sample of each replicate: its replicates' means are the samples.
    const Partial fast = RenderBy(scene, spec, KernelKind::kFast, {index, index + 1});
    const Partial plain = RenderBy(scene, spec, KernelKind::kReference, {index, index + 1});
    for (int64_t pixel = 0; pixel < spec.crop.Pixels(); ++pixel) {
      const auto agree = [&](int place) {
        const int64_t at = pixel * fast.layout.Doubles() + place;
        const double a = fast.values[at], b = plain.values[at];
        return std::abs(a - b) <= tolerance * std::max(std::abs(b), 1e-3);
      };
      // Of plain channels the mean of all replicates is known.
      bool all_agree = true;
      for (int c = 0; c < fast.layout.plain; ++c) all_agree &= agree(fast.layout.Plain(c));
      for (int r = 0; r < kReplicates; ++r) {
        bool agrees = all_agree;
        for (int c = 0; c < 3; ++c) agrees &= agree(fast.layout.Mean(r, c));
        ++samples;
        agreeing += agrees;
      }
    }
  }
  return static_cast<double>(agreeing) / static_cast<double>(samples);
}

}  // namespace strata
