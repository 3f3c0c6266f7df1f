#include "coordinator/lease_table.h"

#include <absl/container/flat_hash_set.h>

#include <algorithm>

namespace strata {

const LeaseRecord& LeaseTable::Grant(const JobId& job, const std::string& worker,
                                     std::vector<UnitId> units, SteadyTime now) {
  const uint64_t id = ++last_id_;
  for (const UnitId& unit : units) holders_[{job, unit}].push_back(id);
  ++count_[worker];
  units_out_[job] += units.size();
  return leases_.emplace(id, LeaseRecord{id, job, worker, std::move(units), now}).first->second;
}

std::vector<LeaseRecord> LeaseTable::Finish(const JobId& job, const UnitId& unit) {
  std::vector<LeaseRecord> emptied;
  const auto entry = holders_.find({job, unit});
  if (entry == holders_.end()) return emptied;
  const std::vector<uint64_t> holders = std::move(entry->second);
  holders_.erase(entry);
  units_out_[job] -= holders.size();
  for (const uint64_t id : holders) {
    const auto lease = leases_.find(id);
    std::erase(lease->second.units, unit);
    if (!lease->second.units.empty()) continue;
    emptied.push_back(lease->second);
    Forget(lease);
  }
  return emptied;
}

bool LeaseTable::GiveUp(const std::string& worker, const JobId& job, const UnitId& unit) {
  const auto entry = holders_.find({job, unit});
  if (entry == holders_.end()) return false;
  for (const uint64_t id : entry->second) {
    const auto lease = leases_.find(id);
    if (lease->second.worker != worker) continue;
    RemoveHolder({job, unit}, id);
    --units_out_[job];
    std::erase(lease->second.units, unit);
    if (lease->second.units.empty()) Forget(lease);
    return true;
  }
  return false;
}

std::vector<LeaseRecord> LeaseTable::RemoveWorker(const std::string& worker) {
  return RemoveIf([&](const LeaseRecord& lease) { return lease.worker == worker; });
}

std::vector<LeaseRecord> LeaseTable::RemoveJob(const JobId& job) {
  std::vector<LeaseRecord> removed =
      RemoveIf([&](const LeaseRecord& lease) { return lease.job == job; });
  units_out_.erase(job);
  return removed;
}

std::vector<LeaseRecord> LeaseTable::RemoveIf(
    const std::function<bool(const LeaseRecord&)>& remove) {
  std::vector<LeaseRecord> removed;
  for (auto lease = leases_.begin(); lease != leases_.end();) {
    const auto current = lease++;
    if (!remove(current->second)) continue;
    for (const UnitId& unit : current->second.units) {
      RemoveHolder({current->second.job, unit}, current->first);
    }
    units_out_[current->second.job] -= current->second.units.size();
    removed.push_back(current->second);
    Forget(current);
  }
  return removed;
}

void LeaseTable::RemoveHolder(const UnitKey& unit, uint64_t lease) {
  const auto entry = holders_.find(unit);
  std::erase(entry->second, lease);
  if (entry->second.empty()) holders_.erase(entry);
}

void LeaseTable::Forget(std::map<uint64_t, LeaseRecord>::iterator lease) {
  const auto count = count_.find(lease->second.worker);
  if (--count->second == 0) count_.erase(count);
  leases_.erase(lease);
}

int LeaseTable::Count(const std::string& worker) const {
  const auto count = count_.find(worker);
  return count == count_.end() ? 0 : count->second;
}

int LeaseTable::Holders(const JobId& job, const UnitId& unit) const {
  const auto entry = holders_.find({job, unit});
  return entry == holders_.end() ? 0 : static_cast<int>(entry->second.size());
}

uint64_t LeaseTable::UnitsOut(const JobId& job) const {
  const auto out = units_out_.find(job);
  return out == units_out_.end() ? 0 : out->second;
}

bool LeaseTable::Holds(const std::string& worker, const JobId& job) const {
  return std::any_of(leases_.begin(), leases_.end(), [&](const auto& entry) {
    return entry.second.worker == worker && entry.second.job == job;
  });
}

int LeaseTable::Workers(const JobId& job) const {
  absl::flat_hash_set<std::string> workers;
  for (const auto& [id, lease] : leases_) {
    if (lease.job == job) workers.insert(lease.worker);
  }
  return static_cast<int>(workers.size());
}

}  // namespace strata
