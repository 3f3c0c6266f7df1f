#include "cli/command_line.h"
#include "cli/commands.h"

int main(int argc, char** argv) {
  strata::CommandLine commands;
  strata::AddRenderCommand(commands);
  strata::AddSubmitCommand(commands);
  strata::AddWatchCommand(commands);
  strata::AddFetchCommand(commands);
  strata::AddListCommands(commands);
  strata::AddControlCommands(commands);
  strata::AddCheckCommand(commands);
  strata::AddReplayCommand(commands);
  strata::AddHealthCommand(commands);
  commands.AddMissing("diff", "strata diff is not there yet in this version");
  strata::Console console = strata::Console::ForProcess();
  return static_cast<int>(commands.Main(argc, argv, console));
}
