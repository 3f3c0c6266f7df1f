#include "cli/commands.h"

namespace strata {

void AddAllCommands(CommandLine& commands) {
  AddRenderCommand(commands);
  AddSubmitCommand(commands);
  AddWatchCommand(commands);
  AddFetchCommand(commands);
  AddListCommands(commands);
  AddControlCommands(commands);
  AddCheckCommand(commands);
  AddReplayCommand(commands);
  AddHealthCommand(commands);
  commands.AddMissing("diff", "strata diff is not there yet in this version");
}

}  // namespace strata
