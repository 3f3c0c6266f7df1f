#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "cli/exit_status.h"
#include "cli/farm_client.h"

namespace strata {

/// Where the coordinator is, for all commands that ask one.
struct FarmAddress {
  std::string server = "127.0.0.1:7447";  ///< HOST:PORT.
  bool insecure = false;
};

/// Adds --server (or STRATA_SERVER) and --insecure.
void AddFarmAddress(CLI::App* command, FarmAddress& address);

/// Dials the coordinator and hands it to `work`.
absl::StatusOr<ExitStatus> WithFarm(
    const FarmAddress& address, const std::function<absl::StatusOr<ExitStatus>(FarmClient&)>& work);

}  // namespace strata
