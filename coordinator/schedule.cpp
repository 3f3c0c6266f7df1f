#include "coordinator/schedule.h"

#include <algorithm>
#include <tuple>

namespace strata {

std::optional<size_t> PickJob(std::span<const JobOffer> offers) {
  const auto before = [](const JobOffer& a, const JobOffer& b) {
    return std::tuple(-a.priority, a.served, a.number) <
           std::tuple(-b.priority, b.served, b.number);
  };
  const auto best = std::min_element(offers.begin(), offers.end(), before);
  if (best == offers.end()) return std::nullopt;
  return best->index;
}

uint64_t UnitsForLease(const LeaseSizing& sizing) {
  if (sizing.samples_per_second <= 0 || sizing.samples_per_unit <= 0) return 1;
  const double by_rate = sizing.samples_per_second * kLeaseSeconds / sizing.samples_per_unit;
  const uint64_t shares = uint64_t{kLeasesPerWorker} * std::max(sizing.workers, 1);
  const uint64_t limit = std::min(kMaxUnitsPerLease, sizing.pending_units / (2 * shares));
  if (by_rate >= static_cast<double>(limit)) return std::max<uint64_t>(limit, 1);
  return std::max<uint64_t>(static_cast<uint64_t>(by_rate), 1);
}

uint32_t WindowFor(uint32_t tiles, int workers) {
  constexpr uint32_t kLeast = 4, kUnitsPerLease = 4;
  const uint32_t wanted = kUnitsPerLease * kLeasesPerWorker * static_cast<uint32_t>(workers);
  return std::max(kLeast, (wanted + tiles - 1) / tiles);
}

SteadyTime ForgiveStall(SteadyTime heard, SteadyTime last_tick, SteadyTime now,
                        std::chrono::milliseconds heartbeat) {
  const SteadyTime::duration gap = now - last_tick;
  if (gap <= heartbeat) return heard;
  return std::min(now, heard + (gap - heartbeat));
}

std::optional<std::pair<JobId, UnitId>> PickStraggler(
    const LeaseTable& leases, const std::string& idle_worker, SteadyTime now,
    const std::function<bool(const JobId&)>& may_render) {
  for (const auto& [id, lease] : leases.leases()) {
    if (now - lease.granted < kStragglerAge) break;
    if (lease.worker == idle_worker || !may_render(lease.job)) continue;
    for (const UnitId& unit : lease.units) {
      if (leases.Holders(lease.job, unit) == 1) return std::pair(lease.job, unit);
    }
  }
  return std::nullopt;
}

}  // namespace strata
