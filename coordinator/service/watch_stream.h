#pragma once

#include <memory>
#include <optional>

#include "common/sync.h"
#include "coordinator/farm.h"
#include "strata/v1/client.grpc.pb.h"

namespace strata {

/// One client following one job. It keeps the newest status alone: what changes while a write is in
/// flight replaces what waited, so a slow client costs no memory.
class WatchStream final : public grpc::ServerWriteReactor<v1::WatchResponse>,
                          public std::enable_shared_from_this<WatchStream> {
 public:
  /// Owned by gRPC from then on.
  static grpc::ServerWriteReactor<v1::WatchResponse>* Start(Farm& farm, const JobId& job);

 private:
  explicit WatchStream(Farm& farm) : farm_(farm) {}
  void Subscribe(const JobId& job);
  void OnStatus(const JobStatus& status);
  void WriteNext() STRATA_REQUIRES(mutex_);
  void FinishLocked(const absl::Status& status) STRATA_REQUIRES(mutex_);

  // Called by gRPC.
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  Farm& farm_;
  std::shared_ptr<WatchStream> self_;  ///< Until OnDone.
  Mutex mutex_;
  v1::WatchResponse write_;                                    ///< gRPC's while writing_.
  std::optional<JobStatus> latest_ STRATA_GUARDED_BY(mutex_);  ///< Not yet written.
  std::optional<uint64_t> subscription_ STRATA_GUARDED_BY(mutex_);
  bool last_ STRATA_GUARDED_BY(mutex_) = false;  ///< A final status was taken; no more follow.
  bool writing_ STRATA_GUARDED_BY(mutex_) = false;
  bool finished_ STRATA_GUARDED_BY(mutex_) = false;
};

}  // namespace strata
