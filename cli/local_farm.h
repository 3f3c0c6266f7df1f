#pragma once

#include <memory>
#include <vector>

#include "cli/farm_client.h"
#include "cli/temporary_directory.h"

namespace strata {

class CoordinatorServer;
class InProcessWorker;

/// A coordinator and its workers in this process, over gRPC's in-process channel: the same code as
/// on a farm. Its state is gone when it is.
class LocalFarm {
 public:
  /// `threads` for each worker; both at least 1.
  static absl::StatusOr<std::unique_ptr<LocalFarm>> Start(int workers, int threads);
  ~LocalFarm();

  FarmClient& client() { return *client_; }

 private:
  explicit LocalFarm(TemporaryDirectory directory);

  // In the order of their making: workers stop first, files go last.
  TemporaryDirectory directory_;
  std::unique_ptr<CoordinatorServer> coordinator_;
  std::unique_ptr<FarmClient> client_;
  std::vector<std::unique_ptr<InProcessWorker>> workers_;
};

}  // namespace strata
