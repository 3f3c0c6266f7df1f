#include "cli/farm_address.h"

namespace strata {

void AddFarmAddress(CLI::App* command, FarmAddress& address) {
  const std::string group = "Server";
  command->add_option("--server", address.server, "The coordinator")
      ->type_name("HOST:PORT")
      ->envname("STRATA_SERVER")
      ->capture_default_str()
      ->group(group);
  command->add_flag("--insecure", address.insecure, "Connect without TLS beyond this machine")
      ->group(group);
}

absl::StatusOr<ExitStatus> WithFarm(
    const FarmAddress& address,
    const std::function<absl::StatusOr<ExitStatus>(FarmClient&)>& work) {
  STRATA_ASSIGN_OR_RETURN(const std::unique_ptr<FarmClient> client,
                          FarmClient::Dial(address.server, address.insecure));
  return work(*client);
}

}  // namespace strata
