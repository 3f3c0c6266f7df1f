#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "common/digest.h"
#include "common/job.h"
#include "common/unit.h"

// What coordinator and worker say to each other, as values: the cores of both speak these over a
// link (coordinator/worker_link.h, worker/session/coordinator_link.h), so that they can be tested
// without a network. common/wire turns them into strata.v1 messages and back.

namespace strata {

inline constexpr uint32_t kProtocol = 1;

// ---- worker to coordinator ----

/// The first message of a worker.
struct Hello {
  uint32_t protocol = kProtocol;
  std::string build;             ///< Revision of the sources this worker was built from.
  uint32_t kernel_revision = 0;  ///< Grows whenever a change may alter the bits of a sample.
  std::map<std::string, std::string> libraries;  ///< Name to version: embree, openimageio, ...
  std::string isa;                               ///< What Embree was pinned to, "avx2".
  Digest traced;     ///< Digest of a small scene rendered by every compiled kernel.
  std::string name;  ///< For people; need not be unique.
  std::vector<std::string> tags;
  uint32_t threads = 0;
  uint64_t memory_limit = 0;  ///< Bytes; 0: none.
};

/// Sent whenever nothing else was for a heartbeat period.
struct Heartbeat {};

/// Asks for at most kFileChunkBytes of a file of a job from `offset` bytes on; each request is
/// answered by exactly one FileChunk, so that the asker alone decides how much is on its way.
struct FileRequest {
  Digest digest;
  uint64_t offset = 0;
};

/// A rendered unit.
struct UnitResult {
  JobId job;
  uint64_t lease = 0;
  Partial partial;
  double load_seconds = 0;  ///< Seconds this worker took to load the job's scene; 0: it had it.
  /// Pixels of the job's crop in which no rays are traced. For display alone.
  int64_t background_pixels = 0;
};

/// A unit, or a whole job (scene that does not load), that this worker cannot render.
struct UnitFailure {
  JobId job;
  uint64_t lease = 0;
  UnitId unit;
  std::string reason;     ///< One sentence.
  std::string replay;     ///< A command that shows the failure; may be empty.
  bool job_wide = false;  ///< The fault is in the job's scene or spec and not in the unit.
};

/// No more leases, please: the worker leaves once it has sent what it holds.
struct Draining {};

using FromWorker = std::variant<Hello, Heartbeat, FileRequest, UnitResult, UnitFailure, Draining>;

// ---- coordinator to worker ----

struct Welcome {
  std::string worker;         ///< The id the coordinator knows this worker by ("w-3").
  uint32_t heartbeat_ms = 0;  ///< Send something at least this often.
  uint32_t silence_ms = 0;    ///< After so long a silence leases are given to others.
};

/// The worker may not join; it prints the reason and ends (or retries where `retry` says so).
struct Refusal {
  std::string reason;
  bool retry = false;
};

/// What to render; the job is described once for each connection, before its first lease.
struct JobDescription {
  JobId job;
  JobSpec spec;
};
struct Lease {
  JobId job;
  uint64_t lease = 0;           ///< Never reused by a coordinator.
  std::vector<WorkUnit> units;  ///< To be rendered in this order.
};

/// Stop rendering this job and forget its leases; results already sent do no harm.
struct CancelJob {
  JobId job;
};
/// Give these units up: another worker was faster.
struct CancelLease {
  uint64_t lease = 0;
};

struct FileChunk {
  Digest digest;
  uint64_t offset = 0;  ///< Of `data` in the file.
  uint64_t total = 0;   ///< Bytes of the whole file.
  std::string data;     ///< At most 1 MiB.
  std::string error;    ///< Not empty: the file cannot be had, and why.
};

/// Finish what you hold, ask for no more.
struct Drain {};

using ToWorker =
    std::variant<Welcome, Refusal, JobDescription, Lease, CancelJob, CancelLease, FileChunk, Drain>;

inline constexpr uint64_t kFileChunkBytes = 1 << 20;

}  // namespace strata
