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
  AddDiffCommand(commands);
  AddReplayCommand(commands);
  AddHealthCommand(commands);
  AddLabCommand(commands);
}

}  // namespace strata
