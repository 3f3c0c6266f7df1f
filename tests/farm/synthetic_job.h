#pragma once

#include <cstdlib>
#include <functional>
#include <optional>

#include "coordinator/next_round.h"
#include "tests/farm/synthetic_image.h"

namespace strata {

inline JobSpec SyntheticSpec(PlaneSize size, TargetKind target, double value,
                             AllocationKind allocation = AllocationKind::kRing,
                             uint32_t spp = 1 << 16) {
  JobSpec spec;
  spec.width = static_cast<int>(size.width);
  spec.height = static_cast<int>(size.height);
  spec.crop = {0, 0, spec.width, spec.height};
  spec.spp = spp;
  spec.target = target;
  spec.target_value = value;
  spec.allocation = allocation;
  return spec;
}

/// The samples of each replicate that pixel i has after a plan; `now` without one.
inline uint32_t EndOf(const std::optional<RoundPlan>& plan, const PixelStatistics& now, size_t i) {
  if (!plan) return now.samples[i];
  const size_t width = now.size.width;
  return plan->ClassOf(static_cast<int>(i % width), static_cast<int>(i / width)).range.end;
}

inline std::vector<uint32_t> EndsOf(const std::optional<RoundPlan>& plan,
                                    const PixelStatistics& now) {
  std::vector<uint32_t> ends(now.samples.size());
  for (size_t i = 0; i < ends.size(); ++i) ends[i] = EndOf(plan, now, i);
  return ends;
}

/// How a job ended.
struct Finished {
  int rounds = 0;      ///< After the pilot.
  double average = 0;  ///< Samples of a pixel, over all replicates.
  NextRound last;
};

/// Renders all rounds of a job as the farm plans them.
inline Finished RenderJob(SyntheticRender& render, const JobSpec& spec) {
  Finished finished;
  render.RenderTo(PlanFirstRound(spec).classes[0].range.end);
  for (;;) {
    const PixelStatistics now = render.Statistics();
    finished.last = PlanNextRound(spec, 1 + static_cast<uint32_t>(finished.rounds), now);
    if (!finished.last.plan || finished.rounds == 50) break;
    ++finished.rounds;
    render.RenderTo(EndsOf(finished.last.plan, now));
  }
  finished.average = render.AverageSamples();
  return finished;
}

/// How often an experiment is repeated; the environment's STRATA_SEEDS, for long runs.
inline int SeedsOr(int usual) {
  const char* seeds = std::getenv("STRATA_SEEDS");
  return seeds != nullptr ? std::atoi(seeds) : usual;
}

}  // namespace strata
