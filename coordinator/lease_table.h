#pragma once

#include <absl/container/flat_hash_map.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/unit.h"
#include "coordinator/steady_time.h"

namespace strata {

/// Units given to a worker.
struct LeaseRecord {
  uint64_t id = 0;  ///< Grows with time.
  JobId job;
  std::string worker;
  std::vector<UnitId> units;  ///< Those not received yet, in the order they are rendered.
  SteadyTime granted;
};

/// Who renders what. Not thread-safe.
class LeaseTable {
 public:
  const LeaseRecord& Grant(const JobId& job, const std::string& worker, std::vector<UnitId> units,
                           SteadyTime now);

  /// Takes a unit out of all leases that hold it; returns those that hold nothing any more, which
  /// are forgotten.
  std::vector<LeaseRecord> Finish(const JobId& job, const UnitId& unit);
  /// Takes a unit out of one worker's leases alone; true when a lease held it.
  bool GiveUp(const std::string& worker, const JobId& job, const UnitId& unit);

  /// Forgets all leases of a worker or a job and returns them, oldest first.
  std::vector<LeaseRecord> RemoveWorker(const std::string& worker);
  std::vector<LeaseRecord> RemoveJob(const JobId& job);

  int Count(const std::string& worker) const;
  /// How many leases hold the unit.
  int Holders(const JobId& job, const UnitId& unit) const;
  /// Units of the job in leases; one that two hold counts twice.
  uint64_t UnitsOut(const JobId& job) const;
  bool Holds(const std::string& worker, const JobId& job) const;
  /// Different workers that hold leases of the job.
  int Workers(const JobId& job) const;

  /// All leases, oldest first.
  const std::map<uint64_t, LeaseRecord>& leases() const { return leases_; }

 private:
  using UnitKey = std::pair<JobId, UnitId>;
  std::vector<LeaseRecord> RemoveIf(const std::function<bool(const LeaseRecord&)>& remove);
  void RemoveHolder(const UnitKey& unit, uint64_t lease);
  void Forget(std::map<uint64_t, LeaseRecord>::iterator lease);

  uint64_t last_id_ = 0;
  std::map<uint64_t, LeaseRecord> leases_;
  absl::flat_hash_map<UnitKey, std::vector<uint64_t>> holders_;
  absl::flat_hash_map<std::string, int> count_;  ///< By worker.
  absl::flat_hash_map<JobId, uint64_t> units_out_;
};

}  // namespace strata
