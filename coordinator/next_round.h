#pragma once

#include <limits>
#include <optional>

#include "coordinator/pixel_statistics.h"
#include "coordinator/round_plan.h"

// Which rounds a job has. Pure functions: a plan depends on the spec and on what the film holds
// when the rounds before are wholly merged, for TargetKind::kTime on the time left too.
//
// With ring allocation, for a sample budget, `--error` and `--rmse`, a pixel's own statistics have
// no part in how many samples it gets, to the last bit. They have a small one, through figures of
// the whole image, with `uniform` and an error target (one count for all), and with `--time` (the
// clock, and the rays of all pixels); with `greedy` they have all.

namespace strata {

/// What only the coordinator's clock knows.
struct TimeLeft {
  double seconds = std::numeric_limits<double>::infinity();
  /// Of all workers together, as measured so far; infinite before that.
  double rays_per_second = std::numeric_limits<double>::infinity();
};

/// What comes after a round.
struct NextRound {
  std::optional<RoundPlan> plan;  ///< Nothing: the job ends here.
  double samples_left = 0;        ///< Estimate of all samples from here to the end.
  double deviation = 0;           ///< Its standard error.
  bool target_met = false;        ///< By what the film holds. True where there is no target.
  double target_share = 1;        ///< See JobStatus.
};

/// The same samples for all pixels: the whole budget where it is spread evenly, otherwise a pilot.
RoundPlan PlanFirstRound(const JobSpec& spec);

/// Whether no round can follow `finished` > 0 rounds, whatever the film holds.
bool IsLastRound(const JobSpec& spec, uint32_t finished);

/// The round after `finished` > 0 rounds. `now` is the film's snapshot.
NextRound PlanNextRound(const JobSpec& spec, uint32_t finished, const PixelStatistics& now,
                        const TimeLeft& left = {});

}  // namespace strata
