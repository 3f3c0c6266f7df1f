#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "coordinator/lease_table.h"

// Decisions of the scheduler as pure functions of what is known and of `now`.

namespace strata {

/// A worker renders one lease while another waits, so that it never waits on the network.
inline constexpr int kLeasesPerWorker = 2;
/// How long a lease should take, as far as units allow.
inline constexpr double kLeaseSeconds = 1;
inline constexpr uint64_t kMaxUnitsPerLease = 64;
/// A lease this old may be duplicated for a worker that has nothing else to do.
inline constexpr std::chrono::milliseconds kStragglerAge{1000};

/// A job with units for some worker.
struct JobOffer {
  size_t index = 0;     ///< The caller's.
  int priority = 0;     ///< Higher first.
  double served = 0;    ///< Work received and leased so far; less first among equal priorities.
  uint64_t number = 0;  ///< Of submission; breaks ties.
};
/// The index of the job to lease from; nothing when there are no offers.
std::optional<size_t> PickJob(std::span<const JobOffer> offers);

struct LeaseSizing {
  double samples_per_second = 0;  ///< Of the worker on this job; 0: not measured yet.
  double samples_per_unit = 0;
  uint64_t pending_units = 0;  ///< Of the job, not leased yet, the one at hand included.
  int workers = 1;             ///< That may render this job.
};
/// Units for one lease, at least 1: about a second's worth, and near the end of a job no more than
/// leave every worker its share of what is left.
uint64_t UnitsForLease(const LeaseSizing& sizing);

/// How far ahead of its tile's merge front a unit may be leased: enough that all workers find units
/// however few tiles there are, and otherwise little, so that few partials wait.
uint32_t WindowFor(uint32_t tiles, int workers);

/// When a worker was last heard, not counting time in which the coordinator itself stood still
/// between two ticks: of a gap, one heartbeat period counts.
SteadyTime ForgiveStall(SteadyTime heard, SteadyTime last_tick, SteadyTime now,
                        std::chrono::milliseconds heartbeat);

/// The unit to render a second time on an idle worker: the next one of the oldest lease that is old
/// enough, is another worker's, and whose unit nobody else renders. `may_render` says whether the
/// idle worker may take units of a job.
std::optional<std::pair<JobId, UnitId>> PickStraggler(
    const LeaseTable& leases, const std::string& idle_worker, SteadyTime now,
    const std::function<bool(const JobId&)>& may_render);

}  // namespace strata
