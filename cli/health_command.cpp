#include <memory>

#include "cli/commands.h"
#include "cli/farm_address.h"
#include "cli/json.h"

namespace strata {
namespace {

struct HealthOptions {
  FarmAddress farm;
  bool json = false;
};

}  // namespace

void AddHealthCommand(CommandLine& commands) {
  const auto options = std::make_shared<HealthOptions>();
  CLI::App* command = commands.Add(
      "health", "Ask whether a coordinator is serving (exit status 0: it is)",
      {"strata health", "strata health --server 10.0.0.5:7447 --insecure"},
      [options](Console& console) {
        return WithFarm(options->farm, [&](FarmClient& farm) -> absl::StatusOr<ExitStatus> {
          STRATA_RETURN_IF_ERROR(farm.Health());
          const std::string& server = options->farm.server;
          console.Result(options->json ? Json{{"server", server}, {"status", "SERVING"}}.dump()
                                       : server + " is serving");
          return ExitStatus::kDone;
        });
      });
  command->add_flag("--json", options->json, "Print a JSON object");
  AddFarmAddress(command, options->farm);
}

}  // namespace strata
